// Deprecated, for one release: include "isoshell/boolean_union.h".
#pragma once

#include "isoshell/deprecated.h"
