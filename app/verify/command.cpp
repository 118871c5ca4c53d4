#include "app/run/interruption.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "app/verify/choice.hpp"
#include "app/verify/report.hpp"
#include "app/verify/verify.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/processors.hpp"
#include "fascia/stepper.hpp"
#include "gpu/space/device.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace fascia::app {
namespace {

/// Says on standard error how far it is: on a terminal in one line that is overwritten.
class Teller {
 public:
  Teller(bool quiet, std::size_t runs) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), runs_(runs) {}
  ~Teller() {
    if (!quiet_ && terminal_) say("\r\033[K");
  }
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  void tell(const std::string& name) {
    ++ended_;
    if (quiet_) return;
    if (terminal_)
      say("\r\033[K{} of {} runs: {}", ended_, runs_, name);
    else if (ended_ % kEvery == 0)
      say("{} of {} runs\n", ended_, runs_);
    std::fflush(stderr);
  }

 private:
  static constexpr std::size_t kEvery = 20;
  bool quiet_, terminal_;
  std::size_t runs_, ended_ = 0;
};

void require_backend(const VerifyOptions& options) {
  if (options.backend != "cuda") return;
  try {
    gpu::require_device();
  } catch (const gpu::NoDevice& e) {
    throw BackendError(e.what());
  }
}

void write_files(const Verification& v, const VerifyOptions& options, const VerifyDirectory& directory) {
  directory.write("verify.csv", csv_of(v));
  directory.write("verify.html", html_of(v, directory));
  directory.write("verify.json", json_text(v));
  if (options.validation && !v.interrupted) io::replace_file(*options.validation, validation_page(v.runs, v.outcomes));
}

}  // namespace

int verify_command(const VerifyOptions& options) {
  if (options.validation && (!options.full || !options.names.empty()))
    throw InputError("verify: --write-validation needs every case; add --full, and leave the names out");
  const Registry registry = read_registry(options.cases ? *options.cases : cases_folder());
  ChosenRuns chosen = choose(registry, options.names, options.full || options.list);
  if (options.list) {
    print_registry(chosen);
    return kDone;
  }
  if (chosen.runs.empty())
    throw InputError(
        fmt::format("verify: the {} runs that are meant take long; add --full, or name one itself", chosen.long_left));
  Interruption interruption;
  require_backend(options);
  const Clock::time_point start = Clock::now();
  Verification v{
      this_certificate(),
      {options.jobs > 0 ? options.jobs : available_processors(), options.backend, options.time_limit, options.pictures},
      std::move(chosen.runs),
      {},
      chosen.long_left};
  const VerifyDirectory directory(options.output);
  directory.write("verify.json", json_text(v));
  {
    Teller teller(options.quiet || options.json, v.runs.size());
    v.outcomes = run_cases(
        v.runs, v.settings, directory, [&](std::size_t r, const RunOutcome&) { teller.tell(v.runs[r].name); },
        [&] { return interruption.requested(); });
  }
  v.interrupted = interruption.requested();
  v.seconds = seconds_since(start);
  write_files(v, options, directory);
  if (options.json)
    fmt::print("{}", json_text(v));
  else
    fmt::print("{}results in {}: verify.html, verify.csv, verify.json\n", text_of(v), directory.path().string());
  if (v.interrupted) return 128 + interruption.signal();
  return count(v).good() ? kDone : kNotConverged;
}

}  // namespace fascia::app
