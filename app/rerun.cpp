#include "app/rerun.hpp"

#include "app/compare/arrays.hpp"
#include "app/machine.hpp"
#include "app/run/messages.hpp"
#include "app/run/run_scene.hpp"
#include "core/base/errors.hpp"
#include "io/digest.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The digest of a file, or that it is not there.
std::string digest_of(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(file, none)) return "";  // a terminal or pipe would be waited for
  try {
    return io::sha256_of(file);
  } catch (const FileError&) {
    return "";
  }
}

/// JSON holds UTF-8 alone: other bytes of a name stand as replacement characters.
const char* broken_name(const fs::path& file) {
  return file.string().find("\xEF\xBF\xBD") == std::string::npos ? "" : ", or has a name that is no UTF-8";
}

void tell_changed_files(const Json& then) {
  const fs::path scene = then.at("scene_file").get<std::string>();
  const std::string now = digest_of(scene);
  if (now.empty())
    say("{} is no longer there{}; the text that the result holds is run\n", scene.string(), broken_name(scene));
  else if (now != then.at("scene_sha256"))
    say("{} has changed since; the text that the result holds is run\n", scene.string());
  for (const Json& file : then.at("files")) {
    const auto path = file.at("path").get<std::string>();
    if (const std::string digest = digest_of(path); !digest.empty() && digest != file.at("sha256"))
      say("{} has changed since; the results may differ\n", path);
  }
}

void tell_other_program(const Json& then) {
  const Machine m = this_machine();
  const Json &program = then.at("program"), &machine = then.at("machine");
  const auto tell = [](const char* name, const std::string& before, const std::string& now) {
    if (before != now) say("{}: \"{}\" then, \"{}\" now\n", name, before, now);
  };
  tell("version", program.at("version"), m.fascia);
  tell("commit", program.at("commit"), m.commit);
  tell("compiler", program.at("compiler"), m.compiler);
  tell("flags", program.at("flags"), m.flags);
  tell("machine", machine.at("cpu"), m.cpu);
}

}  // namespace

int rerun_result(const RerunOptions& options) {
  const Json summary = read_summary(options.directory);
  if (!summary.contains("provenance"))
    throw InputError(fmt::format(
        "{}: does not say where it came from (a version before 0.2 wrote it); run its scene, and use fascia compare",
        (options.directory / "summary.json").string()));
  RunOptions run;
  try {
    const Json& then = summary.at("provenance");
    run.scene = then.at("scene_file").get<std::string>();
    run.text = then.at("scene").get<std::string>();
    run.overrides = then.at("overrides").get<std::vector<std::string>>();
    tell_changed_files(then);
    tell_other_program(then);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(
        fmt::format("{}: its provenance is damaged: {}", (options.directory / "summary.json").string(), e.what()));
  }
  std::error_code none;
  fs::path beside = fs::weakly_canonical(options.directory, none);
  if (none) beside = options.directory;
  run.output = options.output.value_or(fs::path(beside.string() + ".rerun"));
  run.quiet = options.quiet;
  run.no_estimate = true;  // nothing of it is compared
  if (fs::equivalent(*run.output, options.directory, none))
    throw InputError(fmt::format("--output {}: is the result itself; name another directory", run.output->string()));
  const int status = run_scene(run);
  if (status > kNotConverged) return status;
  const ResultDifference difference = compare_results(options.directory, *run.output);
  fmt::print("{} against {}:\n", run.output->string(), options.directory.string());
  const bool equal = print_difference(difference, options.tolerance);
  return equal ? kDone : kDiffers;
}

}  // namespace fascia::app
