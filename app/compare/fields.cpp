#include "app/compare/fields.hpp"

#include "app/compare/arrays.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "io/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace fascia::app {
namespace {

using Field = io::FieldArray;
using MeshPointer = std::shared_ptr<const io::VisualMesh>;

/// Rotation vectors jump at a turn of π: near it nothing lies between them.
constexpr double kMostTurn = 3;

bool is_compared(const std::string& name) {
  static const std::set<std::string> left_out = {"rest_position", "to_outer_face", "director",
                                                 "axis_x",        "axis_y",        "axis_z"};
  return !left_out.contains(name);
}

const Field* find(const io::VisualMesh& mesh, const std::string& name) {
  for (const Field& field : mesh.point_fields)
    if (field.name == name) return &field;
  return nullptr;
}

void evaluate(const Field& field, const Stencil& stencil, double factor, std::vector<double>& out) {
  const auto n = at(field.components);
  out.assign(n, 0);
  for (std::size_t k = 0; k < stencil.points.size(); ++k)
    for (std::size_t c = 0; c < n; ++c)
      out[c] += factor * stencil.weights[k] * field.values[at(stencil.points[k]) * n + c];
}

double squared(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return sum;
}

bool turns_too_far(const Field& rotation) {
  for (std::size_t i = 0; i + 2 < rotation.values.size(); i += 3)
    if (std::hypot(rotation.values[i], rotation.values[i + 1], rotation.values[i + 2]) > kMostTurn) return true;
  return false;
}

/// Root mean square of the interpolation's error over that of the field.
double error_of(const Field& field, const std::vector<Stencil>& checks) {
  double error = 0, size = 0;
  std::vector<double> value;
  for (const Stencil& check : checks) {
    evaluate(field, check, 1, value);
    error += squared(value);
    evaluate(field, {{check.points.back()}, {1}}, 1, value);
    size += squared(value);
  }
  return size > 0 ? std::sqrt(error / size) : 0;
}

/// Adds one state of a field.
/// @param scale  of b
void add_state(FieldDifference& d, const BodyPair& pair, const Field& a, const Field& b, double scale, double time) {
  double difference = 0, of_a = 0, of_b = 0, measure = 0;
  std::vector<double> x, y, apart;
  for (const SharedPlace& place : pair.places) {
    evaluate(a, place.a, 1, x);
    evaluate(b, place.b, scale, y);
    apart = x;
    for (std::size_t c = 0; c < x.size(); ++c) apart[c] -= y[c];
    const double here = squared(apart), xx = squared(x), yy = squared(y);
    difference += place.weight * here;
    of_a += place.weight * xx;
    of_b += place.weight * yy;
    measure += place.weight;
    d.magnitude = std::max({d.magnitude, std::sqrt(xx), std::sqrt(yy)});
    if (d.a.empty() || std::sqrt(here) > d.largest) {
      d.largest = std::sqrt(here);
      d.place = place.X;
      d.time = time;
      d.a = x;
      d.b = y;
    }
  }
  if (measure <= 0) return;
  const double mean = std::sqrt(difference / measure);
  if (mean > d.root_mean) {
    d.root_mean = mean;
    d.worst_time = time;
  }
  d.root_mean_a = std::max(d.root_mean_a, std::sqrt(of_a / measure));
  d.root_mean_b = std::max(d.root_mean_b, std::sqrt(of_b / measure));
  d.interpolation = std::max({d.interpolation, error_of(a, pair.checks_a), error_of(b, pair.checks_b)});
}

class Fields {
 public:
  Fields(FieldSource& a, FieldSource& b, const FieldChoice& choice) : a_(a), b_(b), choice_(choice) {}

  FieldComparison compare() {
    find_bodies();
    TimePairs times = pair_times(a_.states.times(), a_.kind, b_.states.times(), b_.kind, "states");
    result_.structure.insert(result_.structure.end(), times.structure.begin(), times.structure.end());
    result_.notes.insert(result_.notes.end(), times.notes.begin(), times.notes.end());
    if (choice_.last && !times.pairs.empty()) times.pairs = {times.pairs.back()};
    for (const TimePair& time : times.pairs) add(time);
    tell_pairs();
    const bool same_times = a_.states.times() == b_.states.times() && times.structure.empty();
    result_.same_meshes =
        same_times && a_.states.bodies() == b_.states.bodies() &&
        std::all_of(result_.bodies.begin(), result_.bodies.end(), [](const auto& b) { return b.pair.same_mesh; });
    finish();
    return std::move(result_);
  }

 private:
  bool is_chosen(const std::string& body) const { return choice_.body.empty() || choice_.body == body; }

  bool is_chosen(const Field& field, bool modes) const {
    return is_compared(field.name) && (!modes || field.name == "displacement") &&
           (choice_.field.empty() || choice_.field == field.name);
  }

  void find_bodies() {
    for (const std::string& name : a_.states.bodies())
      if (!is_chosen(name))
        continue;
      else if (b_.states.has(name))
        result_.bodies.push_back({name, {}, 0, b_.volumes[name]});
      else if (!b_.states.times().empty())
        result_.structure.push_back(fmt::format("body \"{}\" is in A alone", name));
    for (const std::string& name : b_.states.bodies())
      if (is_chosen(name) && !a_.states.has(name) && !a_.states.times().empty())
        result_.structure.push_back(fmt::format("body \"{}\" is in B alone", name));
  }

  void add(const TimePair& time) {
    std::vector<std::pair<MeshPointer, MeshPointer>> meshes;
    for (ComparedBody& body : result_.bodies) {
      meshes.emplace_back(a_.states.at(body.name, time.a), b_.states.at(body.name, time.b));
      if (!paired_) pair(body, *meshes.back().first, *meshes.back().second);
    }
    paired_ = true;
    const bool modes = a_.kind == RunKind::modes && b_.kind == RunKind::modes;
    const double scale = modes ? scale_of(meshes) : 1;
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      const auto& [x, y] = meshes[k];
      for (const Field& field : x->point_fields) {
        const Field* other = find(*y, field.name);
        if (!is_chosen(field, modes)) continue;
        if (other == nullptr || other->components != field.components) {
          leave_out(fmt::format("{}: {}", result_.bodies[k].name, field.name));
          continue;
        }
        if (field.name == "rotation" && (turns_too_far(field) || turns_too_far(*other))) {
          note_turn();
          if (!choice_.field.empty())
            result_.structure.push_back(fmt::format("body \"{}\" turns by more than 3 rad", result_.bodies[k].name));
          continue;
        }
        add_state(difference(result_.bodies[k].name, field), result_.bodies[k].pair, field, *other, scale, time.time);
      }
      for (const Field& field : y->point_fields)
        if (!modes && is_chosen(field, modes) && find(*x, field.name) == nullptr)
          leave_out(fmt::format("{}: {}", result_.bodies[k].name, field.name));
    }
  }

  /// A field of a body that one result alone has: a note, unless it is what was asked for.
  void leave_out(const std::string& what) {
    only_in_one_.insert(what);
    if (!choice_.field.empty()) result_.structure.push_back(fmt::format("{} is in one of them alone", what));
  }

  void pair(ComparedBody& body, const io::VisualMesh& x, const io::VisualMesh& y) {
    try {
      body.pair = pair_bodies(x, a_.volumes[body.name], y, b_.volumes[body.name]);
    } catch (const InputError& e) {
      throw InputError(fmt::format("body \"{}\": {}", body.name, e.what()));
    }
    body.places = body.pair.places.size();
  }

  /// The multiple of mode b that is nearest to mode a, both of all bodies.
  double scale_of(const std::vector<std::pair<MeshPointer, MeshPointer>>& meshes) const {
    double ab = 0, bb = 0;
    std::vector<double> x, y;
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      const Field *a = find(*meshes[k].first, "displacement"), *b = find(*meshes[k].second, "displacement");
      if (a == nullptr || b == nullptr) continue;
      for (const SharedPlace& place : result_.bodies[k].pair.places) {
        evaluate(*a, place.a, 1, x);
        evaluate(*b, place.b, 1, y);
        for (std::size_t c = 0; c < x.size(); ++c) ab += place.weight * x[c] * y[c];
        bb += place.weight * squared(y);
      }
    }
    return bb > 0 && ab != 0 ? ab / bb : 1;
  }

  FieldDifference& difference(const std::string& body, const Field& field) {
    for (FieldDifference& d : result_.fields)
      if (d.body == body && d.field == field.name) return d;
    FieldDifference& d = result_.fields.emplace_back();
    d.body = body;
    d.field = field.name;
    d.unit = io::name_of_field(field.name).unit;
    return d;
  }

  void note_turn() {
    const std::string note = "rotation: left out where something turns by more than 3 rad, where its vector jumps";
    if (std::find(result_.notes.begin(), result_.notes.end(), note) == result_.notes.end())
      result_.notes.push_back(note);
  }

  /// How the bodies were compared, and what could not be.
  void tell_pairs() {
    constexpr double kNotTheSame = 0.1;  // of the measure: more than two meshes of one body differ by
    const char* measure[] = {"points", "length", "area", "volume"};
    for (const ComparedBody& b : result_.bodies) {
      if (b.pair.places.empty() && !paired_) continue;
      if (b.pair.left_out > kNotTheSame)
        result_.structure.push_back(fmt::format(
            "body \"{}\": {:.3g} % of the {} of {} lie farther from the other than {:g} of its size; is it "
            "the same body?",
            b.name, 100 * b.pair.left_out, measure[b.pair.dimension], b.pair.sampled == 0 ? "A" : "B", kReach));
      else if (b.pair.left_out > 0)
        result_.notes.push_back(fmt::format("body \"{}\": {:.3g} % of its {} have no counterpart, and are left out",
                                            b.name, 100 * b.pair.left_out, measure[b.pair.dimension]));
      if (b.pair.beside > 0)
        result_.notes.push_back(fmt::format(
            "body \"{}\": {:.3g} % of its {} lie beside the other mesh, by up to {:.3g} m, and are compared with the "
            "nearest place",
            b.name, 100 * b.pair.beside, measure[b.pair.dimension], b.pair.farthest));
    }
    for (const std::string& field : only_in_one_)
      result_.notes.push_back(fmt::format("{}: is in one of the two alone", field));
  }

  /// The largest magnitude of a field in any body; strains and turns are of one kind.
  double magnitude_of(const std::string& field) const {
    const bool turn = field == "rotation" || field == "strain";
    double most = 0;
    for (const FieldDifference& d : result_.fields)
      if (d.field == field || (turn && (d.field == "rotation" || d.field == "strain")))
        most = std::max(most, d.magnitude);
    return most;
  }

  /// Relative differences, once all magnitudes are known.
  void finish() {
    constexpr double kSolved = 1e-8;  // of a field's scale: what Newton's method leaves by default
    Scales scales;
    for (const ComparedBody& b : result_.bodies) scales.length = std::max(scales.length, b.pair.size);
    if (const double strain = magnitude_of("strain"); strain > 0) scales.modulus = magnitude_of("stress") / strain;
    for (FieldDifference& d : result_.fields) {
      const double size = std::max(d.root_mean_a, d.root_mean_b);
      const double nothing = std::max(rounding_of(d.field, scales), kSolved * magnitude_of(d.field));
      d.relative = size > 0 && d.largest > nothing ? d.root_mean / size : 0;
    }
    std::stable_sort(result_.fields.begin(), result_.fields.end(),
                     [](const auto& p, const auto& q) { return p.relative > q.relative; });
  }

  FieldSource &a_, &b_;
  const FieldChoice& choice_;
  FieldComparison result_;
  std::set<std::string> only_in_one_;
  bool paired_ = false;
};

}  // namespace

FieldComparison compare_fields(FieldSource& a, FieldSource& b, const FieldChoice& choice) {
  return Fields(a, b, choice).compare();
}

}  // namespace fascia::app
