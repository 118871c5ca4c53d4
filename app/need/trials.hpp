#pragma once

#include "app/estimate/series.hpp"
#include "app/need/open_scene.hpp"
#include "app/study/child_run.hpp"
#include "app/tune/cost_model.hpp"

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Runs of a scene that look for the cheapest choice that is good enough.
namespace fascia::app {

/// A quantity whose error counts, or is told.
struct Wanted {
  std::string name;   ///< in messages: `"tip"`, `the displacement of "beam"`
  std::string probe;  ///< column of probes.csv
  std::string body;   ///< whose largest displacement it is; empty: a probe of the scene
  Quantity quantity = Quantity::max_displacement;
  std::optional<double> allowed;  ///< relative error; none: it is only told
};

/// Trials below this time are mostly start and noise: they are not told apart by it [s].
inline constexpr double kClearTime = 0.05;

/// What a run may choose.
struct NeedChoice {
  Resolution resolution;
  int steps = 0;                  ///< of equal length in the duration; 0: the time step is the scene's own
  std::string scheme;             ///< kind of the solver; empty: the scene's own
  std::vector<std::string> more;  ///< changes beside, for twins

  auto operator<=>(const NeedChoice&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 sees a 0 in it
};

/// What came of it.
struct Trial {
  NeedChoice choice;
  std::string status, message;  ///< of its summary; why it gave nothing
  double seconds = 0;           ///< set-up and solve, of one run [s]
  double step = 0;              ///< 99th percentile of its steps [s]
  double step_median = 0;       ///< [s]
  double memory = 0;            ///< [bytes]
  double dofs = 0, points = 0, steps = 0, newton = 0;
  double others = 0;                        ///< of the machine's time that others took meanwhile [0, 1]
  bool kept = false;                        ///< an earlier search made it
  std::map<std::string, double> body_mass;  ///< [kg]
  std::vector<Series> values;               ///< by Wanted; empty where it gave nothing

  bool good() const { return !values.empty(); }
};

class KeptTrials;

/// Runs choices, each once, in processes of their own.
class Trials {
 public:
  /// @param scene   with its need, as it was read
  /// @param folder  for the results of trials, which are removed one by one
  /// @param kept    trials that were made before; null: none
  Trials(const Scene& scene, OpenScene open, std::vector<Wanted> wanted, std::filesystem::path folder,
         const KeptTrials* kept, std::function<void(const std::string&)> tell, std::function<bool()> stop);

  const Trial& run(const NeedChoice& choice);
  const Trial* find(const NeedChoice& choice) const;
  const std::deque<Trial>& all() const { return trials_; }
  const OpenScene& open() const { return open_; }
  /// Cells of a body along a direction stay as many as they are at the coarsest level of a family.
  void settle(std::size_t body, int family, int direction);
  /// All levels of a family have twice as many cells along what is not thin of a body; trials that were made are no
  /// levels any more.
  void stretch(std::size_t body, int family);
  const Scene& scene() const { return scene_; }
  const std::vector<Wanted>& wanted() const { return wanted_; }
  /// Its error tells which resolution is better: it is stated, or none is, and it is the displacement of a body.
  bool judges(std::size_t wanted) const;
  bool stopped() const { return stop_(); }
  void tell(const std::string& line) const { tell_(line); }

  /// What makes a scene without a need of a choice, behind the scene's own overrides.
  std::vector<std::string> overrides(const NeedChoice& choice) const;
  /// An iteration of Newton's method costs so many times as much with `more` times the unknowns of a trial, by the
  /// costs that `fascia tune` kept for this machine; none where there are none of its bodies' kinds.
  std::optional<double> tuned_growth(const Trial& trial, double more) const;
  /// The scene that a choice makes.
  Scene scene_of(const NeedChoice& choice) const;
  /// The largest of errors of the quantities over those allowed.
  double over_allowed(const std::vector<double>& errors) const;
  /// The choice in words: "beam: quadratic hexahedra, 8 x 1 x 1 cells; newmark, 64 steps of 16 ms".
  std::string text(const NeedChoice& choice) const;

 private:
  struct CostedBody {
    KindCost cost;
    int dimension = 3;
  };
  /// The bodies of a choice's family; none where the cost of one is not known.
  const std::vector<CostedBody>& costed(const NeedChoice& choice) const;
  /// Changes of the scene, behind its own, of the run that a choice is tried by.
  std::vector<std::string> changes_of_trial(const NeedChoice& choice) const;
  /// Runs it in a process of its own.
  Trial made(const std::vector<std::string>& changes, const NeedChoice& choice);

  const Scene& scene_;
  OpenScene open_;
  std::vector<Wanted> wanted_;
  std::filesystem::path folder_;
  const KeptTrials* kept_;
  std::function<void(const std::string&)> tell_;
  std::function<bool()> stop_;
  std::deque<Trial> trials_;                               ///< references to them stay
  std::optional<CostModel> costs_;                         ///< that are kept for this machine
  mutable std::map<int, std::vector<CostedBody>> costed_;  ///< by family
};

/// Steps are timed anew by the run itself: it may be this much slower.
inline constexpr double kStepSpread = 1.15;

/// The longest steps of a run, times `spread`, are above what the scene needs, and the others well below: the machine
/// did something else meanwhile, and another run may not meet it.
bool interrupted_steps(const Scene& scene, double p99, double median, double spread);
bool interrupted_steps(const Scene& scene, const nlohmann::ordered_json& summary, double spread);

/// Values of a quantity that are rounding alone. @param size  of the largest body [m]
double rounding_of(Quantity quantity, double size);

/// What a scene that states a need asks for, then its other probes.
std::vector<Wanted> wanted_of(const Scene& scene);

/// The largest distance of two quantities over the times that both have, relative to the largest value of the second.
std::optional<double> relative_distance(const Series& a, const Series& b);

}  // namespace fascia::app
