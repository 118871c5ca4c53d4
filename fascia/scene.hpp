#pragma once

/// Scenes as plain data: bodies, materials, regions, constraints, loads, couplings, the solver, probes.
/// All numbers are in SI units. The fields mean what the keys of a scene file of their names mean.
#include "assembly/specification/errors.hpp"
#include "assembly/specification/scene.hpp"
#include "core/base/errors.hpp"
