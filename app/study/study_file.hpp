#pragma once

#include "assembly/specification/region.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// A study: a scene, what is varied in it, what is measured, and what the measures are compared with.
namespace fascia::app {

/// One value of an axis: the changes of the scene that it stands for.
struct AxisValue {
  std::string label;                   ///< as tables show it
  std::vector<std::string> overrides;  ///< "key.path=value", as of --set
  std::optional<double> number;        ///< SI; where the value is a single one
  std::string model;                   ///< of StudyAxis::body, see model_alternative(); empty: none
  double refine = 1;                   ///< factor on the resolution of StudyAxis::body, or of all bodies
};

struct StudyAxis {
  Place place;
  std::string name;
  std::vector<std::string> keys;  ///< that it varies; empty: alternatives
  std::string body;               ///< of models and refinements
  std::vector<AxisValue> values;
};

/// What a measure's error is the distance from.
struct StudyReference {
  enum class Kind { none, value, scene, finest };
  Place place;
  Kind kind = Kind::none;
  std::vector<double> value;            ///< in the unit of `unit_text`'s probe, or SI
  std::vector<std::string> quantities;  ///< values with units, as they were written; empty where all are numbers
  double uncertainty = 0;               ///< relative
  std::string source;                   ///< where the value is from
  std::filesystem::path scene;          ///< whose run gives the value; empty: the base scene
  std::vector<std::string> overrides;   ///< of that scene
};

/// Times of a run at which a measure is looked at.
enum class Moment { end, largest, curve };

/// A probe, or a field that is compared with that of a reference.
struct StudyMeasure {
  Place place;
  std::string name;
  std::string probe;               ///< empty: a field
  std::string field;               ///< of the saved states; empty: a probe
  std::string body;                ///< of the field; empty: all bodies that have it
  std::vector<std::size_t> entry;  ///< of the probe's value: indices into lists; empty: the whole value
  Moment moment = Moment::end;
  std::optional<std::size_t> per;  ///< axis of which each value is a problem with a reference of its own
  StudyReference reference;
};

/// Combinations that are run: all, the first with the first and so on, or those towards the front of time and error.
enum class StudyMode { all, paired, front };
/// What a run costs: its solve [s], its median step [s], its set-up and solve together [s].
enum class StudyCost { solve, step, total };

struct Study {
  std::filesystem::path path;  ///< of the study, or of the scene where it was given on the command line
  std::string title;
  std::filesystem::path base;
  std::vector<std::string> overrides;  ///< of every run
  std::vector<StudyAxis> axes;
  std::vector<StudyMeasure> measures;
  StudyMode mode = StudyMode::all;
  std::optional<StudyCost> cost;  ///< none: step of dynamics with equal steps, else solve
  std::optional<int> dimension;   ///< of what is refined; none: of the bodies
  std::optional<double> need;     ///< error that is good enough: the chosen run is the cheapest below it
  int repeat = 3, warm_up = 1;    ///< of each run that is timed
  bool timed = true;              ///< otherwise several run at once
  double time_limit = 0;          ///< of a run [s]; 0: none
  std::vector<double> budgets;    ///< costs at which the smallest error is told [s]
  std::vector<double> sizes;      ///< numbers of unknowns, likewise
};

/// Reads a study file. @throws SceneError  with everything that is wrong  @throws FileError
Study read_study(const std::filesystem::path& path);

/// A study given on the command line. @param vary  "key=[value, value]"  @param measures  "probe" or "probe.x"
/// @throws SceneError
Study study_of(const std::filesystem::path& scene, const std::vector<std::string>& vary,
               const std::vector<std::string>& measures);

}  // namespace fascia::app
