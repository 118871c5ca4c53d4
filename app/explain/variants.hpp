#pragma once

#include "assembly/specification/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace fascia::app {

enum class VariantKind {
  left_out,  ///< a body with what acts on it
  rigid,
  formulation,
  law,
  order,
  frame_kind,
  coarser,
  fluid,
  damping,
  viscosity,
  coupling,
  newton_tolerance,
  linear_tolerance,
  linear_solver,
  tangent,
  precision,
  backend,
  threads,
  time_step
};

/// A change of a scene that shows what a part of it costs and buys.
struct Variant {
  VariantKind kind = VariantKind::left_out;
  std::string part;                    ///< the key that it is about: "bodies.kidney", "solver.newton.tolerance"
  std::string change;                  ///< a clause: "as `model = \"rigid\"`", "without `couplings.ligament`"
  std::string body;                    ///< whose it is; empty: the scene's
  std::vector<std::string> overrides;  ///< "key.path=value", behind the scene's own
  std::string refused;                 ///< why it is no valid scene; empty where it is one
  bool closer = false;  ///< it costs more and answers closer: its changes are errors of the scene as it is
  double growth = 1;    ///< of the body's nodes
};

/// Facts that only a run of the scene tells.
struct RunFacts {
  bool iterative = false;  ///< conjugate gradients solved
  std::string backend = "cpu";
  int threads = 1;
  int processors = 1;                       ///< threads that may run at once
  std::map<std::string, double> body_mass;  ///< [kg]
};

/// The parts of a scene, each with the changes that leave it out or make it simpler; those that are no valid scene say
/// why.
std::vector<Variant> variants_of(const Scene& scene, const RunFacts& facts);

/// Parts of variants_of, in files of their own.
std::vector<Variant> body_variants(const Scene& scene, const Body& body, const RunFacts& facts);
std::vector<Variant> material_variants(const Scene& scene);
std::vector<Variant> solver_variants(const Scene& scene, const RunFacts& facts);

}  // namespace fascia::app
