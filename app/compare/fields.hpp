#pragma once

#include "app/compare/body_pair.hpp"
#include "app/compare/saved_states.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// A field of a body in two results, over all times that are compared.
struct FieldDifference {
  std::string body, field, unit;
  double relative = 0;  ///< ‖a − b‖ / max(‖a‖, ‖b‖) [-], each the largest over time; 0 where it is rounding,
                        ///< or below 1e-8 of the field in any body: what Newton's method leaves
  double root_mean = 0;  ///< root mean square of |a − b| over the body, at its worst time: ‖a − b‖ / √measure
  double root_mean_a = 0, root_mean_b = 0;  ///< of |a|, |b|; largest over time
  double worst_time = 0;                    ///< of root_mean
  double largest = 0;                       ///< of |a − b|; Frobenius norm of tensors
  double magnitude = 0;                     ///< of |a|, |b|; the largest of both
  Vec3d place{};                            ///< of the largest difference, at rest [m]
  double time = 0;                          ///< of the largest difference
  std::vector<double> a, b;                 ///< the values there
  double interpolation = 0;  ///< what LocalFit's error may add to `relative`: of meshless bodies, from points left out

  std::string name() const { return body + ": " + field; }
};

/// A body that both results have.
struct ComparedBody {
  std::string name;
  BodyPair pair;
  std::size_t places = 0;
  double volume = 0;  ///< of its matter, as B has it [m³]
};

struct FieldComparison {
  std::vector<ComparedBody> bodies;
  std::vector<FieldDifference> fields;  ///< the largest `relative` first
  std::vector<std::string> structure, notes;
  bool same_meshes = false;  ///< of all bodies, and the same times
};

/// A result, as far as its fields are compared.
struct FieldSource {
  SavedStates states;
  RunKind kind = RunKind::statics;
  std::map<std::string, double> volumes;  ///< of the bodies [m³]
};

/// A part of what two results have in common.
struct FieldChoice {
  std::string field;  ///< empty: all
  std::string body;   ///< empty: all
  bool last = false;  ///< at the last time that both reach; otherwise at all
};

/// Compares the point fields that the bodies of two results have in common, as functions of the rest position.
/// Modes are compared by their displacement alone, scaled to one another: their size and sign mean nothing.
/// @throws FileError, InputError  see SavedStates
FieldComparison compare_fields(FieldSource& a, FieldSource& b, const FieldChoice& choice = {});

}  // namespace fascia::app
