#include "app/bench/report.hpp"

#include "app/bench/report_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace fascia::app {
namespace {

using Row = TableRow;

/// A time with three digits or all of its whole milliseconds.
std::string milliseconds(double ms) { return ms >= 100 ? fmt::format("{:.0f}", ms) : fmt::format("{:#.3g}", ms); }

std::string milliseconds(const std::optional<double>& ms) { return ms ? milliseconds(*ms) : "-"; }

std::string label(const Measurement& m) { return BenchBackend{m.backend, m.threads, {}, m.gpus}.label(); }

/// Backends in the order of their first row.
std::vector<std::string> labels(const BenchmarkResult& result) {
  std::vector<std::string> found;
  for (const Measurement& m : result.rows)
    if (std::find(found.begin(), found.end(), label(m)) == found.end()) found.push_back(label(m));
  return found;
}

/// Rows of the same case, which follow one another.
std::vector<std::vector<Measurement>> cases_of(const BenchmarkResult& result) {
  std::vector<std::vector<Measurement>> cases;
  for (const Measurement& m : result.rows) {
    if (cases.empty() || cases.back().front().name != m.name) cases.emplace_back();
    cases.back().push_back(m);
  }
  return cases;
}

/// Both lines above the numbers: what a column belongs to, and what it is.
std::vector<Row> headings(bool published, const std::vector<std::string>& backends) {
  Row above{"", "", "", "", "", ""}, below{"body", "setting", "points", "frames", "neighbours", "iterations"};
  const auto add = [&](const std::string& group, const std::vector<std::string>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      above.push_back(i == 0 ? group : "");
      below.push_back(columns[i]);
    }
  };
  if (published) add("paper", {"CPU ms", "GPU ms"});
  for (const std::string& b : backends) add(b, {"step ms", "CG ms", "|r|/|b|"});
  add("", {"fastest"});
  return {above, below};
}

Row table_row(const std::vector<Measurement>& of_case, bool published, const std::vector<std::string>& backends) {
  const Measurement& first = of_case.front();
  const auto by_step = [](const Measurement& a, const Measurement& b) { return a.step_ms < b.step_ms; };
  const auto by_iterations = [](const Measurement& a, const Measurement& b) {
    return a.cg_iterations < b.cg_iterations;
  };
  const int iterations = std::min_element(of_case.begin(), of_case.end(), by_iterations)->cg_iterations;
  Row row{first.body,
          first.setting,
          fmt::format("{}", first.points),
          fmt::format("{}", first.frames),
          fmt::format("{:.3g}", first.neighbours),
          fmt::format("{}", iterations)};
  if (published) {
    row.push_back(milliseconds(first.published_cpu));
    row.push_back(milliseconds(first.published_gpu));
  }
  for (const std::string& b : backends) {
    const auto m = std::find_if(of_case.begin(), of_case.end(), [&](const Measurement& x) { return label(x) == b; });
    const bool there = m != of_case.end();
    row.push_back(there ? milliseconds(m->step_ms) : "-");
    row.push_back(there ? milliseconds(m->cg_ms) : "-");
    row.push_back(there ? fmt::format("{:.1e}", m->residual) : "-");
  }
  row.push_back(label(*std::min_element(of_case.begin(), of_case.end(), by_step)));
  return row;
}

}  // namespace

std::string result_table(const BenchmarkResult& result, const Machine& machine) {
  const bool published = std::any_of(result.rows.begin(), result.rows.end(), [](const Measurement& m) {
    return m.published_cpu.has_value() || m.published_gpu.has_value();
  });
  const std::vector<std::string> backends = labels(result);
  std::vector<Row> rows = headings(published, backends);
  std::set<std::string> troubles;
  for (const std::vector<Measurement>& of_case : cases_of(result)) {
    rows.push_back(table_row(of_case, published, backends));
    for (const Measurement& m : of_case)
      if (!m.trouble.empty()) troubles.insert(fmt::format("{}: {}\n", m.name, m.trouble));
  }
  constexpr std::size_t kTextColumns = 2;
  std::string text = fmt::format("{}\n\n{}\n{}\n", result.title, aligned(rows, kTextColumns), result.notes);
  for (const std::string& t : troubles) text += t;
  return text + skipped_lines(result.skipped) + machine_lines(machine);
}

std::string result_csv(const BenchmarkResult& result) {
  std::string text =
      "case,body,setting,points,frames,neighbours,dofs,backend,threads,steps,step_ms,step_p99_ms,step_max_ms,cg_ms,"
      "cg_iterations,residual,paper_cpu_ms,paper_gpu_ms,gpus\n";
  for (const Measurement& m : result.rows)
    text += fmt::format("{},{},{},{},{},{:.4g},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{:.6g},{},{},{}\n", m.name,
                        m.body, m.setting, m.points, m.frames, m.neighbours, m.dofs, m.backend, m.threads, m.steps,
                        m.step_ms, m.step_p99_ms, m.step_max_ms, m.cg_ms, m.cg_iterations, m.residual,
                        field(m.published_cpu), field(m.published_gpu), m.gpus);
  return text;
}

nlohmann::ordered_json result_json(const BenchmarkResult& result, const Machine& machine) {
  nlohmann::ordered_json j = json_head(result.name, result.title, result.notes, machine);
  j["rows"] = nlohmann::ordered_json::array();
  for (const Measurement& m : result.rows)
    j["rows"].push_back({{"case", m.name},
                         {"body", m.body},
                         {"setting", m.setting},
                         {"points", m.points},
                         {"frames", m.frames},
                         {"neighbours", number(m.neighbours)},
                         {"dofs", m.dofs},
                         {"backend", m.backend},
                         {"threads", m.threads},
                         {"gpus", m.gpus},
                         {"steps", m.steps},
                         {"step_ms", number(m.step_ms)},
                         {"step_p99_ms", number(m.step_p99_ms)},
                         {"step_max_ms", number(m.step_max_ms)},
                         {"cg_ms", number(m.cg_ms)},
                         {"cg_iterations", m.cg_iterations},
                         {"residual", number(m.residual)},
                         {"trouble", m.trouble},
                         {"paper_cpu_ms", number(m.published_cpu)},
                         {"paper_gpu_ms", number(m.published_gpu)}});
  j["skipped"] = json_of(result.skipped);
  return j;
}

}  // namespace fascia::app
