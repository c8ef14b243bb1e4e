// Umbrella header.
#pragma once

#include "isoshell/device_info.h"
#include "isoshell/digest.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/point_file.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/mend.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/remesh.h"
#include "isoshell/stages.h"
#include "isoshell/to_host.h"
#include "isoshell/unite.h"
