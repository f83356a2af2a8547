// See readme_library.cpp.
#pragma once

#include "core/status.h"
#include "skin/cpu_skinner.h"

#include <functional>

using DrawFunction = std::function<void(const limber::DeformedMesh&)>;

limber::Status RaiseHandle(const char* baked_file, const char* name, DrawFunction draw);
