// Deprecated, for one release: include "isoshell/repair.h".
#pragma once

#include "isoshell/deprecated.h"
