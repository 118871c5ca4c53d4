#include "app/bench/command.hpp"
#include "app/compare/command.hpp"
#include "app/completion.hpp"
#include "app/explain/explain.hpp"
#include "app/extremes/extremes.hpp"
#include "app/list.hpp"
#include "app/rerun.hpp"
#include "app/results/provenance.hpp"
#include "app/run/messages.hpp"
#include "app/run/process_memory.hpp"
#include "app/run/run_scene.hpp"
#include "app/study/study.hpp"
#include "app/tools.hpp"
#include "app/tune/tune.hpp"
#include "app/verify/verify.hpp"
#include "app/version.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/solver/settings.hpp"
#include "fascia/stepper.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <new>
#include <system_error>

namespace {

using namespace fascia::app;

/// A number that is no less than `least`, or with `above` more; of whole numbers where `whole`.
CLI::Validator number_from(double least, bool above, bool whole) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    if (number && (above ? value > least : value >= least) && (!whole || value == std::floor(value))) return "";
    return fmt::format("{} must be a {}number {} {:g}", text, whole ? "whole " : "", above ? "above" : "from", least);
  };
  return CLI::Validator(check, "");
}

void add_scene_options(CLI::App& command, RunOptions& options) {
  command.add_option("scene", options.scene, "scene file (TOML)")->required();
  command
      .add_option("--set", options.overrides,
                  "set a key: --set key.path=value, or remove it: --set key.path= (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--backend", options.backend, "cpu, cuda or auto")->check(CLI::IsMember({"cpu", "cuda", "auto"}));
  command.add_flag("--estimate", options.estimate, "estimate the errors of the results by runs at other resolutions");
  command.add_option("--gpus", options.gpus, "GPUs that share the points of meshless solids")
      ->check(CLI::Range(1, fascia::kMostDevices));
}

CLI::App* add_bench(CLI::App& app, BenchOptions& options) {
  CLI::App* bench = app.add_subcommand("bench", "time published and other cases on this machine's backends");
  bench->add_option("name", options.name, "which benchmark; without a name they are listed");
  bench->add_option("--sizes", options.sizes, "only these numbers of points or cells: --sizes 360,6070,34610")
      ->delimiter(',')
      ->check(number_from(0, true, false));
  bench->add_option("--max-points", options.max_points, "leave out larger cases")->check(number_from(0, true, false));
  bench->add_option("--settings", options.settings, "paper: as published; default: the program's own choice; both")
      ->check(CLI::IsMember({"paper", "default", "both"}));
  bench
      ->add_option("--repeat", options.repeat,
                   "steps, or calls of kernels, that are timed; otherwise as many as a second, or a tenth, has")
      ->check(number_from(1, false, true));
  bench->add_option("--backend", options.backend, "cpu or cuda; otherwise all that there are")
      ->check(CLI::IsMember({"cpu", "cuda"}));
  bench->add_option("--threads", options.threads, "threads beside the run on one, 0 for all")
      ->check(number_from(0, false, true));
  bench->add_option("--gpus", options.gpus, "numbers of GPUs that share a run, beside one another: --gpus 1,2,4")
      ->delimiter(',')
      ->check(CLI::Range(1, fascia::kMostDevices));
  bench->add_option("--output", options.output, "directory for the table, CSV, JSON and the scenes");
  bench->add_flag("--json", options.json, "print JSON, and nothing else, on standard output");
  bench->add_flag("--quiet", options.quiet, "do not say what is being timed");
  return bench;
}

constexpr std::array kCommands{"run",   "check",  "rerun", "compare", "explain", "extremes",
                               "study", "verify", "tune",  "bench",   "list",    "completion"};

CLI::App* add_rerun(CLI::App& app, RerunOptions& options) {
  CLI::App* rerun = app.add_subcommand("rerun", "repeat a run from what its result says, and compare the two");
  rerun->add_option("directory", options.directory, "directory of the results")->required();
  rerun->add_option("--output", options.output, "directory of the repeated run; otherwise DIRECTORY.rerun");
  rerun->add_option("--tolerance", options.tolerance, "relative difference that is still equal")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  rerun->add_flag("--quiet", options.quiet, "no progress and no summary of the run");
  return rerun;
}

CLI::App* add_compare(CLI::App& app, CompareOptions& options) {
  CLI::App* compare = app.add_subcommand("compare", "compare two results: fields, probes, energies, cost, settings");
  compare->add_option("a", options.a, "directory of results")->required();
  compare->add_option("b", options.b, "another one")->required();
  compare->add_option("--tolerance", options.tolerance, "relative difference that is still equal")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  compare->add_option("--only", options.only, "fields and probes that count: --only displacement,tip")->delimiter(',');
  compare->add_flag("--json", options.json, "print JSON, and nothing else, on standard output");
  return compare;
}

CLI::App* add_study(CLI::App& app, StudyOptions& options) {
  CLI::App* study = app.add_subcommand("study", "run variations of a scene, and tell their errors beside their times");
  study->add_option("study", options.study, "study file (TOML); or a scene, with --vary")->required();
  const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* help) {
    study->add_option(name, values, help)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  repeatable("--vary", options.vary, "values of a key: --vary 'solver.threads=[1, 2]' (repeatable)");
  repeatable("--measure", options.measures, "probe, or a component of it: --measure tip.y (repeatable)");
  study->add_option("--output", options.output, "directory of the study; otherwise results/NAME");
  study->add_option("--repeat", options.repeat, "times that each run is timed")->check(number_from(1, false, true));
  study->add_flag("--untimed", options.untimed, "several runs at once; their times mean little");
  study->add_option("--jobs", options.jobs, "runs at once of what is not timed")->check(number_from(1, false, true));
  study->add_option("--svg", options.svg, "directory for the plots as SVG");
  study->add_option("--png", options.png, "directory for the plots as PNG (needs rsvg-convert)");
  study->add_flag("--json", options.json, "print study.json, and nothing else, on standard output");
  study->add_flag("--quiet", options.quiet, "no progress");
  return study;
}

CLI::App* add_verify(CLI::App& app, VerifyOptions& options) {
  CLI::App* verify = app.add_subcommand("verify", "compare this program with published and closed-form values");
  verify->add_option("names", options.names, "runs, cases, topics, features or globs of them; otherwise all");
  verify->add_option("--output", options.output, "directory of the report")->capture_default_str();
  verify->add_flag("--full", options.full, "long runs too");
  verify->add_flag("--list", options.list, "list runs, cases and features, and run nothing");
  verify->add_option("--jobs", options.jobs, "runs at once, each on one thread; otherwise as many as processors")
      ->check(number_from(1, false, true));
  verify->add_option("--backend", options.backend, "cpu, cuda or auto; otherwise as each scene says")
      ->check(CLI::IsMember({"cpu", "cuda", "auto"}));
  verify->add_option("--time-limit", options.time_limit, "of each run, in seconds; 0: none")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  verify->add_option("--cases", options.cases, "folder of case files in the place of the program's own");
  verify->add_option("--write-validation", options.validation, "write docs/validation.md to this file");
  verify->add_flag("--pictures", options.pictures, "pictures of the scenes that have one");
  verify->add_flag("--json", options.json, "print verify.json, and nothing else, on standard output");
  verify->add_flag("--quiet", options.quiet, "no progress");
  return verify;
}

CLI::App* add_explain(CLI::App& app, ExplainOptions& options) {
  CLI::App* explain = app.add_subcommand("explain", "say what each part of a scene costs and buys, and what to change");
  explain->add_option("scene", options.scene, "scene file (TOML)")->required();
  explain
      ->add_option("--set", options.overrides,
                   "set a key: --set key.path=value, or remove it: --set key.path= (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  explain->add_option("--output", options.output,
                      "directory for explain.json and the run; otherwise they are not kept");
  explain->add_option("--change", options.change, "relative change of probes that a suggestion may make")
      ->check(number_from(0, true, false))
      ->capture_default_str();
  explain->add_option("--repeat", options.repeat, "turns in which what is suggested is timed")
      ->check(number_from(1, false, true))
      ->capture_default_str();
  explain->add_option("--time-limit", options.time_limit, "seconds after which no change is begun; 0: none")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  explain->add_flag("--quick", options.quick, "from one run, with estimates");
  explain->add_flag("--json", options.json, "print explain.json, and nothing else, on standard output");
  explain->add_flag("--quiet", options.quiet, "no progress");
  return explain;
}

CLI::App* add_extremes(CLI::App& app, ExtremesOptions& options) {
  CLI::App* extremes = app.add_subcommand(
      "extremes", "map where runs are right, refused or stopped: materials, sizes, steps and loads over decades");
  extremes->add_option("scene", options.scene, "scene whose numbers are swept; otherwise the program's own map");
  extremes->add_option("--set", options.overrides, "set a key of the scene: --set key.path=value (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  extremes->add_option("--output", options.output, "directory of the map")->capture_default_str();
  extremes->add_option("--compare", options.compare, "extremes.csv of an older map: exit 3 where a cell is worse");
  extremes->add_option("--beside", options.beside,
                       "what another program said of the cells: a table of bench/calculix.py");
  extremes
      ->add_option("--quicker-than", options.quicker_than, "with --compare: only cells that took less seconds there")
      ->check(number_from(0, true, false));
  extremes->add_option("--only", options.only, "cells whose names hold all these words: --only shell,static")
      ->delimiter(',');
  extremes->add_flag("--reduced", options.reduced, "the two ends of every axis alone, one kind of run each");
  extremes->add_option("--pairs", options.pairs, "cells with two extreme numbers, drawn at random, always the same")
      ->check(number_from(0, false, true))
      ->capture_default_str();
  extremes->add_flag("--list", options.list, "list the cells, and run nothing");
  extremes->add_option("--jobs", options.jobs, "runs at once, each on one thread; otherwise as many as processors")
      ->check(number_from(1, false, true));
  extremes->add_option("--backend", options.backend, "cpu or cuda; the twins run on the processor")
      ->check(CLI::IsMember({"cpu", "cuda"}));
  extremes->add_option("--time-limit", options.time_limit, "of each run, in seconds; 0: none")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  extremes->add_option("--memory-limit", options.memory_limit, "of each run, in bytes; 0: none")
      ->check(number_from(0, false, false))
      ->capture_default_str();
  extremes->add_flag("--resume", options.resume, "go on with a map that was interrupted");
  extremes->add_flag("--quiet", options.quiet, "no progress");
  return extremes;
}

CLI::App* add_tune(CLI::App& app, TuneOptions& options) {
  CLI::App* tune = app.add_subcommand("tune", "time small scenes on this machine, so that times can be foretold");
  tune->add_flag("--quick", options.quick, "only what is needed to fit anything");
  tune->add_flag("--json", options.json, "print tune.json, and nothing else, on standard output");
  return tune;
}

/// Prints the script; what it completes is read off the commands themselves.
int print_completion(const CLI::App& app) {
  std::vector<CommandWords> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandWords& words = commands.emplace_back();
    words.name = command->get_name();
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) words.options.push_back("--" + name);
    if (words.name == "completion") words.arguments = {"bash"};
    if (words.name == "list") words.arguments = listed_things();
    if (words.name == "bench") words.arguments.assign(kBenchmarkNames.begin(), kBenchmarkNames.end());
  }
  fmt::print("{}", bash_completion(commands));
  return kDone;
}

int dispatch(int argc, char** argv) {
  CLI::App app{"fascia: simulator of connective tissue and the organs that it ties together", "fascia"};
  app.set_version_flag("--version", [] { return version_text(); });
  app.require_subcommand(1);
  RunOptions options;
  CLI::App* run = app.add_subcommand("run", "simulate a scene and write its results");
  add_scene_options(*run, options);
  run->add_option("--output", options.output, "directory of the results");
  run->add_option("--threads", options.threads, "number of threads, 0 for all")->check(number_from(0, false, true));
  run->add_flag("--quiet", options.quiet, "no progress and no summary");
  run->add_flag("--json", options.json, "print summary.json, and nothing else, on standard output");
  run->add_flag("-v,--verbose", options.verbose, "a line for each step");
  run->add_flag("--new-trials", options.new_trials,
                "of a scene with [need]: make its trials anew, though earlier searches kept them");
  CLI::App* check = app.add_subcommand("check", "read and validate a scene, and say what would be simulated");
  add_scene_options(*check, options);
  if (argc > 1 && argv[1][0] != '-' &&
      std::find(kCommands.begin(), kCommands.end(), std::string_view(argv[1])) == kCommands.end()) {
    const std::string_view word = argv[1];
    say("fascia: \"{}\" is {}; must be one of {}, as in: fascia run {}\n", word,
        word == "resume" || word == "fit" ? "not supported yet" : "no command", fmt::join(kCommands, ", "),
        word.ends_with(".toml") ? word : "SCENE");
    return kWrongInput;
  }
  RerunOptions rerun_options;
  const CLI::App* rerun = add_rerun(app, rerun_options);
  CompareOptions compare_options;
  const CLI::App* compare = add_compare(app, compare_options);
  StudyOptions study_options;
  const CLI::App* study = add_study(app, study_options);
  TuneOptions tune_options;
  const CLI::App* tune = add_tune(app, tune_options);
  VerifyOptions verify_options;
  const CLI::App* verify = add_verify(app, verify_options);
  ExplainOptions explain_options;
  const CLI::App* explain = add_explain(app, explain_options);
  ExtremesOptions extremes_options;
  const CLI::App* extremes = add_extremes(app, extremes_options);
  BenchOptions bench_options;
  const CLI::App* bench = add_bench(app, bench_options);
  CLI::App* list = app.add_subcommand("list", "list scenes that come with the program, quantities of probes, or units");
  std::string what;
  list->add_option("what", what, "scenes, quantities or units")->required()->check(CLI::IsMember(listed_things()));
  CLI::App* completion = app.add_subcommand("completion", "print a script that completes commands, options and keys");
  std::string shell;
  completion->add_option("shell", shell, "bash")->required()->check(CLI::IsMember({"bash"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = app.exit(e, std::cout, std::cerr);
    return code == 0 ? kDone : kWrongInput;
  }
  if (completion->parsed()) return print_completion(app);
  if (list->parsed()) return list_things(what);
  if (bench->parsed()) return tools().bench(bench_options);
  if (rerun->parsed()) return tools().rerun(rerun_options);
  if (compare->parsed()) return tools().compare(compare_options);
  if (study->parsed()) return tools().study(study_options);
  if (tune->parsed()) return tools().tune(tune_options);
  if (verify->parsed()) return tools().verify(verify_options);
  if (explain->parsed()) return tools().explain(explain_options);
  if (extremes->parsed()) return tools().extremes(extremes_options);
  return run->parsed() ? run_scene(options) : check_scene(options);
}

/// Where one is closed, the next file that is opened would take its place, and what is printed.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF && open("/dev/null", O_RDWR) < 0) std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  keep_freed_memory();
  remember_command(argc, argv);
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);  // told as errors of what is written
  try {
    require_room();
    const int status = dispatch(argc, argv);
    if (std::fflush(stdout) == 0) return status;
    say("fascia: standard output cannot be written: {}\n", std::strerror(errno));
    return kFileProblem;
  } catch (const fascia::SceneError& e) {
    for (const fascia::Diagnostic& d : e.diagnostics()) say("{}\n", d.text());
    return kWrongInput;
  } catch (const fascia::InputError& e) {
    say("{}\n", e.what());
    return kWrongInput;
  } catch (const fascia::StateError& e) {
    say("{}\n", e.what());
    return kNotConverged;
  } catch (const fascia::FileError& e) {
    say("{}\n", e.what());
    return kFileProblem;
  } catch (const fascia::BackendError& e) {
    say("{}\n", e.what());
    return kNoBackend;
  } catch (const std::bad_alloc&) {
    const FreeMemory left = free_memory();
    say("out of memory: {:.3g} MB are free{}; use a smaller grid, or linear = {{ kind = \"cg\" }}{}\n",
        left.bytes / 1e6, left.limit, left.limit.empty() ? "" : ", or raise the limit");
    return kWrongInput;
  } catch (const std::filesystem::filesystem_error& e) {
    say("fascia: {}\n", e.what());
    return kFileProblem;
  } catch (const std::system_error& e) {
    if (e.code() != std::errc::resource_unavailable_try_again) {
      say("fascia: {}\n", e.what());
      return kFileProblem;
    }
    say("fascia: a thread cannot be started: {}; use --threads 1, or raise the limit on memory or processes (ulimit "
        "-v, -u)\n",
        e.code().message());
    return kWrongInput;
  } catch (const std::exception& e) {
    say("fascia: {}\n", e.what());
    return 1;
  }
}
