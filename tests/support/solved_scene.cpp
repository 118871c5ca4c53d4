#include "tests/support/solved_scene.hpp"

#include "app/reader/parse.hpp"
#include "app/results/probes.hpp"
#include "app/results/results.hpp"
#include "app/run/load_scene.hpp"
#include "core/base/errors.hpp"
#include "fascia/choose_backend.hpp"
#include "fascia/run/run_simulation.hpp"
#include "fascia/scene_file.hpp"
#include "tests/support/paths.hpp"

#include <optional>

namespace fascia::test {
namespace {

/// Keeps the rows of a run.
class Rows final : public RunListener {
 public:
  explicit Rows(const Simulation& s) : simulation_(s), values_(s.probes.size(), nlohmann::json::array()) {}

  void stepped(const StepInfo& step) override { seconds_.add(step.seconds); }
  void show(double time, const ProbedState& at, const ProbeValues& values) override {
    std::vector<double> row{time};
    for (const std::vector<double>& of_probe : values) row.insert(row.end(), of_probe.begin(), of_probe.end());
    app::take_row(simulation_, values, values_);
    if (simulation_.scene.solver.time_step_automatic) row.push_back(at.time_step);
    rows_.push_back(std::move(row));
  }

  void save(double, const State&) override { ++saved_; }

  int saved() const { return saved_; }
  const app::StepSeconds& seconds() const { return seconds_; }
  const std::vector<nlohmann::json>& values() const { return values_; }
  std::vector<std::vector<double>>& rows() { return rows_; }

 private:
  const Simulation& simulation_;
  app::StepSeconds seconds_;
  std::vector<nlohmann::json> values_;
  std::vector<std::vector<double>> rows_;
  int saved_ = 0;
};

}  // namespace

SolvedScene::SolvedScene(const std::string& scene, Settings settings, int threads)
    : SolvedScene(of_file(scene, std::move(settings), threads)) {
  EXPECT_TRUE(ok_) << scene << ": " << message();
}

SolvedScene SolvedScene::of_file(const std::string& scene, Settings settings, int threads) {
  if (threads > 0) settings.push_back("solver.threads=" + std::to_string(threads));
  SolvedScene solved;
  solved.solve([&] { return read_scene_file(source_dir() / "scenes" / (scene + ".toml"), settings); });
  return solved;
}

SolvedScene SolvedScene::of_text(const std::string& text, Settings settings) {
  settings.emplace_back("solver.backend='cpu'");
  SolvedScene solved;
  solved.solve([&] { return app::parse_scene_text(text, "scene.toml", settings); });
  return solved;
}

template <class Read>
void SolvedScene::solve(const Read& read) {
  std::optional<Simulation> built;
  try {
    built.emplace(app::load_scene(read()));
  } catch (const InputError& e) {
    summary_ = {{"status", "refused"}, {"message", e.what()}};
    return;
  } catch (const SceneError& e) {
    summary_ = {{"status", "refused"}, {"message", e.what()}};
    return;
  }
  Simulation& s = *built;
  const Backend backend = choose_backend(s);
  app::warn_of_backend(s, backend);
  ThreadPool pool(s.scene.solver.threads);
  Rows rows(s);
  const RunEnd end = run_simulation(s, backend, pool, rows);
  s.warnings.add(end.warnings);
  const app::RunTimes times{end.setup_seconds,     end.solve_seconds, end.output_seconds,
                            end.processor_seconds, rows.seconds(),    {}};
  summary_ = nlohmann::json(app::summary(s, end, times, pool.size(), rows.values(), {}));
  ok_ = end.done();
  table_.columns = {"time"};
  for (const ResolvedProbe& probe : s.probes)
    for (const std::string& name : probe_columns(probe)) table_.columns.push_back(name);
  if (s.scene.solver.time_step_automatic) table_.columns.push_back("time_step");
  table_.rows = std::move(rows.rows());
  saved_ = rows.saved();
}

}  // namespace fascia::test
