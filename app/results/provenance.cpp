#include "app/results/provenance.hpp"

#include "app/machine.hpp"
#include "app/reader/scene_tree.hpp"
#include "app/scene/toml_text.hpp"
#include "app/version.hpp"
#include "io/digest.hpp"

#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>

namespace fascia::app {
namespace {

struct Start {
  std::string command, time;
  std::vector<std::string> first_words;
};

Start& start() {
  static Start start;
  return start;
}

/// The loader takes its own words from the front of those that the process was started with; the system keeps them all.
/// @param count  of the words that are left: the program and its arguments
std::vector<std::string> words_up_to_program(std::size_t count) {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  if (words.size() <= count || count == 0) return {"fascia"};
  words.resize(words.size() - count + 1);
  return words;
}

std::string whole_path(const std::filesystem::path& path) {
  std::error_code failed;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path, failed);
  return (failed ? path : whole).string();
}

}  // namespace

std::string quoted_for_shell(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

void remember_command(int argc, char** argv) {
  std::vector<std::string> words;
  std::transform(argv, argv + argc, std::back_inserter(words), quoted_for_shell);
  start().time = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  start().command = fmt::format("{}", fmt::join(words, " "));
  start().first_words = words_up_to_program(words.size());
}

std::string remembered_command() { return start().command; }

std::vector<std::string> first_words_of_command() {
  const std::vector<std::string>& words = start().first_words;
  return words.empty() ? std::vector<std::string>{"fascia"} : words;
}

std::vector<std::filesystem::path> input_files(const Scene& scene) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::filesystem::path& file) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  for (const Body& b : scene.bodies) {
    if (const auto* mesh = std::get_if<FileDomain>(&b.domain)) add(mesh->path);
    if (const auto* frames = std::get_if<SampleFile>(&b.frames)) add(frames->path);
    if (const auto* points = std::get_if<SampleFile>(&b.points)) add(points->path);
  }
  return files;
}

std::string simulation_digest(const Scene& scene) {
  std::string text = toml_text(plain_tree(scene, {}, {"output", "probes", "silence"})) + "\n";
  for (const std::filesystem::path& file : input_files(scene)) text += io::sha256_of(file) + "\n";
  return io::sha256(text).substr(0, 16);
}

nlohmann::ordered_json provenance_of(const Simulation& s) {
  const Machine m = this_machine();
  nlohmann::ordered_json j;
  j["scene"] = s.scene.text;
  j["scene_sha256"] = io::sha256(s.scene.text);
  j["scene_file"] = whole_path(s.scene.path);
  j["overrides"] = s.scene.overrides;
  j["output"] = whole_path(s.scene.output.directory);
  j["files"] = nlohmann::ordered_json::array();
  for (const std::filesystem::path& file : input_files(s.scene))
    j["files"].push_back({{"path", whole_path(file)}, {"sha256", io::sha256_of(file)}});
  j["command"] = start().command;
  j["started"] = start().time;
  j["units"] = "SI: m, kg, s, N, Pa, rad";
  j["program"] = {{"version", m.fascia}, {"commit", m.commit}, {"backends", m.backends}, {"compiler", m.compiler},
                  {"flags", m.flags},    {"build", m.build},   {"processor", tuning()}};
  for (const auto& [name, version] : m.libraries) j["program"]["libraries"][name] = version;
  j["machine"] = {{"host", m.host},       {"system", m.system}, {"cpu", m.cpu},
                  {"threads", m.threads}, {"memory", m.memory}, {"gpu", m.gpu}};
  return j;
}

}  // namespace fascia::app
