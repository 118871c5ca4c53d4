#pragma once

#include "tests/support/run_numbers.hpp"

#include <string>
#include <utility>
#include <vector>

namespace fascia {
struct Scene;
}

namespace fascia::test {

/// A scene of this project, solved by the library in the test's own process: no program is started, and no file
/// written. It tells what the program's summary and probes.csv would.
class SolvedScene : public RunNumbers {
 public:
  /// A test fails where the run does not come to its end.
  /// @param scene    name of a file under scenes/, without ".toml"
  /// @param threads  0: as the scene says
  explicit SolvedScene(const std::string& scene, Settings settings = {}, int threads = 0);

  /// A file, or a text, is solved to any end.
  static SolvedScene of_file(const std::string& scene, Settings settings = {}, int threads = 0);
  static SolvedScene of_text(const std::string& text, Settings settings = {});

  /// "converged", "unstable", ...; "refused" where the scene is.
  std::string status() const { return summary_.value("status", "none"); }
  std::string message() const { return summary_.value("message", ""); }
  /// How many states were saved.
  int saved() const { return saved_; }

 private:
  SolvedScene() = default;
  template <class Read>
  void solve(const Read& read);

  int saved_ = 0;
};

}  // namespace fascia::test
