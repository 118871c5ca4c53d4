#include "app/verify/certificate.hpp"

#include "app/results/provenance.hpp"
#include "app/version.hpp"
#include "io/digest.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace fascia::app {

Certificate this_certificate() {
  Certificate certificate;
  certificate.machine = this_machine();  // which loads the module for GPUs where there is one
  certificate.command = remembered_command();
  certificate.processor_level = tuning();
  for (const std::string& file : files_of_program()) certificate.files.emplace_back(file, io::sha256_of(file));
  return certificate;
}

nlohmann::ordered_json json_of(const Certificate& c) {
  const Machine& m = c.machine;
  nlohmann::ordered_json j;
  j["date"] = m.date;
  j["command"] = c.command;
  j["program"] = {{"version", m.fascia},           {"commit", m.commit}, {"backends", m.backends},
                  {"compiler", m.compiler},        {"flags", m.flags},   {"build", m.build},
                  {"processor", c.processor_level}};
  j["program"]["libraries"] = nlohmann::ordered_json::object();
  for (const auto& [name, version] : m.libraries) j["program"]["libraries"][name] = version;
  j["program"]["sha256"] = nlohmann::ordered_json::object();
  for (const auto& [file, digest] : c.files) j["program"]["sha256"][file] = digest;
  j["machine"] = {{"host", m.host},     {"system", m.system}, {"cpu", m.cpu},      {"threads", m.threads},
                  {"memory", m.memory}, {"gpu", m.gpu},       {"driver", m.driver}};
  return j;
}

}  // namespace fascia::app
