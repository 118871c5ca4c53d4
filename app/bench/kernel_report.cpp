#include "app/bench/kernel_report.hpp"

#include "app/bench/report_parts.hpp"
#include "app/machine.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

namespace fascia::app {
namespace {

/// Three digits, or all of whole numbers.
std::string digits(double value) { return value >= 100 ? fmt::format("{:.0f}", value) : fmt::format("{:#.3g}", value); }

std::string digits(const std::optional<double>& value) { return value ? digits(*value) : "-"; }

std::string bytes_text(double bytes) {
  return bytes < 1e6 ? fmt::format("{:.3g} kB", bytes / 1e3) : fmt::format("{:.3g} MB", bytes / 1e6);
}

std::optional<double> rate(const KernelRow& row) {
  if (!row.traffic) return std::nullopt;
  return row.traffic->bytes() / row.time.median / 1e9;
}

std::optional<double> flop_rate(const KernelRow& row) {
  if (!row.traffic || !row.traffic->flops) return std::nullopt;
  return *row.traffic->flops / row.time.median / 1e9;
}

std::optional<double> fraction(const KernelRow& row) {
  if (!row.traffic) return std::nullopt;
  return row.fraction();
}

std::optional<double> of_copy(const KernelRow& row) {
  if (!row.traffic) return std::nullopt;
  return row.traffic->bytes() / row.time.median / row.copy_rate;
}

std::string limit_of(const KernelRow& row) {
  if (!row.traffic) return "";
  return row.flop_seconds > row.memory_seconds ? "arithmetic" : "memory";
}

std::string bits_text(const KernelRow& row) {
  if (!row.bits_equal) return "-";
  return *row.bits_equal ? "equal" : "DIFFERENT";
}

/// Between which times four of five lie, by `unit`.
std::string spread(const CallTimes& t, double unit) {
  return fmt::format("{}..{}", digits(t.low / unit), digits(t.high / unit));
}

/// Body and points where they are not those of the row above.
TableRow first_columns(const std::vector<KernelRow>& rows, std::size_t i) {
  const KernelRow& row = rows[i];
  const bool same = i > 0 && rows[i - 1].name == row.name;
  return {same ? "" : row.body, same ? "" : fmt::format("{:.0f}", row.points)};
}

std::vector<TableRow> kernel_rows(const std::vector<KernelRow>& rows) {
  std::vector<TableRow> table{{"body", "points", "kernel", "by", "threads", "ns", "low..high", "GB/s", "GFLOP/s",
                               "limit", "fraction", "error", "bits"}};
  table.reserve(rows.size() + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KernelRow& row = rows[i];
    const double unit = 1e-9 * row.items;
    TableRow line = first_columns(rows, i);
    for (const std::string& text :
         {row.kernel, row.item, fmt::format("{}", row.threads), digits(row.time.median / unit), spread(row.time, unit),
          digits(rate(row)), digits(flop_rate(row)), limit_of(row), fmt::format("{:.2f}", row.fraction()),
          fmt::format("{:.1e}", row.error), bits_text(row)})
      line.push_back(text);
    table.push_back(std::move(line));
  }
  return table;
}

std::vector<TableRow> scaling_rows(const std::vector<KernelRow>& rows) {
  std::vector<TableRow> table{{"body", "points", "growth", "kernel", "threads", "ms", "low..high", "speed-up",
                               "efficiency", "GB/s", "of copy", "error", "bits"}};
  table.reserve(rows.size() + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KernelRow& row = rows[i];
    TableRow line = first_columns(rows, i);
    for (const std::string& text :
         {row.growth, row.kernel, fmt::format("{}", row.threads), digits(1e3 * row.time.median), spread(row.time, 1e-3),
          fmt::format("{:.2f}", row.speed_up.value_or(1)), fmt::format("{:.2f}", row.efficiency.value_or(1)),
          digits(rate(row)), row.traffic ? fmt::format("{:.2f}", *of_copy(row)) : "-", fmt::format("{:.1e}", row.error),
          bits_text(row)})
      line.push_back(text);
    table.push_back(std::move(line));
  }
  return table;
}

/// Says where threads did not find a processor each: their rate of arithmetic tells.
std::string disturbance(const Teams& teams) {
  constexpr double kUndisturbed = 0.75;
  const MachineLimits &one = teams.front()->limits, &all = teams.back()->limits;
  const double gain = all.flops() / one.flops(), more = static_cast<double>(all.threads()) / one.threads();
  if (gain >= kUndisturbed * more) return "";
  return fmt::format(
      "{} threads multiply {:.2f} times as fast as {}: other programs took processors, or these share "
      "units; speed-ups are of what was left.\n",
      all.threads(), gain, one.threads());
}

/// Rates of the machine: those of caches by working set, threads beside one another.
std::string limits_table(const Teams& teams) {
  std::map<double, std::vector<std::string>> by_size;
  TableRow heading{"working set, GB/s"};
  std::string flops;
  for (const std::unique_ptr<Team>& team : teams) {
    heading.push_back(fmt::format("threads: {}, read", team->limits.threads()));
    heading.push_back("copy");
    heading.push_back("update");
    flops += fmt::format("{}{} on {}", flops.empty() ? "" : ", ", digits(team->limits.flops() / 1e9),
                         team->limits.threads());
    for (const auto& [size, rates] : team->limits.measured()) by_size[size];
  }
  std::vector<TableRow> table{heading};
  table.reserve(by_size.size() + 1);
  for (const auto& [size, none] : by_size) {
    TableRow& line = table.emplace_back(TableRow{bytes_text(size)});
    for (const std::unique_ptr<Team>& team : teams) {
      const auto rates = team->limits.measured().find(size);
      const bool there = rates != team->limits.measured().end();
      line.push_back(there ? digits(rates->second.read / 1e9) : "");
      line.push_back(there ? digits(rates->second.copy / 1e9) : "");
      line.push_back(there ? digits(rates->second.update / 1e9) : "");
    }
  }
  return fmt::format("{}Largest: main memory. Multiplications and additions, GFLOP/s: {} thread{}.\n{}",
                     aligned(table, 0), flops, teams.back()->limits.threads() == 1 ? "" : "s", disturbance(teams));
}

std::string table_of(const KernelResult& result, const std::vector<TableRow>& rows, const Teams& teams,
                     const Machine& machine, std::size_t left) {
  return fmt::format("{}\n\n{}\n{}\n\n{}{}load before: {:.2g} programs\n{}", result.title, aligned(rows, left),
                     result.notes, limits_table(teams), skipped_lines(result.skipped), result.load,
                     machine_lines(machine));
}

std::string csv_of(const KernelResult& result) {
  std::string text =
      "case,body,points,nodes,unknowns,growth,kernel,threads,item,items,calls,ns,ns_low,ns_high,read_bytes,"
      "written_bytes,flops,gb_per_s,gflop_per_s,limit,fraction,of_copy,speed_up,efficiency,error,bits_equal\n";
  for (const KernelRow& r : result.rows) {
    const double unit = 1e-9 * r.items;
    const std::optional<double> read = r.traffic ? std::optional(r.traffic->read) : std::nullopt;
    const std::optional<double> written = r.traffic ? std::optional(r.traffic->written) : std::nullopt;
    text += fmt::format(
        "{},{},{:.0f},{},{},{},{},{},{},{:.0f},{},{:.6g},{:.6g},{:.6g},{},{},{},{},{},{},{},{},{},{},"
        "{:.3g},{}\n",
        r.name, r.body, r.points, r.nodes, r.unknowns, r.growth, r.kernel, r.threads, r.item, r.items, r.time.calls,
        r.time.median / unit, r.time.low / unit, r.time.high / unit, field(read), field(written),
        field(r.traffic ? r.traffic->flops : std::nullopt), field(rate(r)), field(flop_rate(r)), limit_of(r),
        field(fraction(r)), field(of_copy(r)), field(r.speed_up), field(r.efficiency), r.error,
        r.bits_equal ? (*r.bits_equal ? "1" : "0") : "");
  }
  return text;
}

nlohmann::ordered_json json_of(const KernelRow& r) {
  const double unit = 1e-9 * r.items;
  nlohmann::ordered_json j{{"case", r.name},
                           {"body", r.body},
                           {"points", r.points},
                           {"nodes", r.nodes},
                           {"unknowns", r.unknowns},
                           {"growth", r.growth},
                           {"kernel", r.kernel},
                           {"threads", r.threads},
                           {"item", r.item},
                           {"items", r.items},
                           {"calls", r.time.calls},
                           {"ns", number(r.time.median / unit)},
                           {"ns_low", number(r.time.low / unit)},
                           {"ns_high", number(r.time.high / unit)},
                           {"read_bytes", nullptr},
                           {"written_bytes", nullptr},
                           {"flops", nullptr},
                           {"gb_per_s", number(rate(r))},
                           {"gflop_per_s", number(flop_rate(r))},
                           {"limit", limit_of(r)},
                           {"fraction", number(fraction(r))},
                           {"of_copy", number(of_copy(r))},
                           {"speed_up", number(r.speed_up)},
                           {"efficiency", number(r.efficiency)},
                           {"error", number(r.error)},
                           {"bits_equal", nullptr}};
  if (r.bits_equal) j["bits_equal"] = *r.bits_equal;
  if (!r.traffic) return j;
  j["read_bytes"] = r.traffic->read;
  j["written_bytes"] = r.traffic->written;
  j["flops"] = number(r.traffic->flops);
  return j;
}

std::string json_text(const KernelResult& result, const Teams& teams, const Machine& machine) {
  nlohmann::ordered_json j = json_head(result.name, result.title, result.notes, machine);
  j["load"] = result.load;
  j["limits"] = nlohmann::ordered_json::array();
  for (const std::unique_ptr<Team>& team : teams) {
    nlohmann::ordered_json sets = nlohmann::ordered_json::array();
    for (const auto& [size, rates] : team->limits.measured())
      sets.push_back({{"bytes", size},
                      {"read_bytes_per_s", rates.read},
                      {"copy_bytes_per_s", rates.copy},
                      {"update_bytes_per_s", rates.update}});
    j["limits"].push_back({{"threads", team->limits.threads()},
                           {"flops_per_s", team->limits.flops()},
                           {"last_cache_bytes", last_level_cache()},
                           {"working_sets", std::move(sets)}});
  }
  j["rows"] = nlohmann::ordered_json::array();
  for (const KernelRow& row : result.rows) j["rows"].push_back(json_of(row));
  j["skipped"] = json_of(result.skipped);
  return j.dump(2) + "\n";
}

}  // namespace

BenchReport report_of_kernels(const KernelResult& result, const Teams& teams, const std::vector<BenchmarkCase>& cases) {
  const Machine machine = this_machine();
  constexpr std::size_t kTextColumns = 4;
  return {table_of(result, kernel_rows(result.rows), teams, machine, kTextColumns), csv_of(result),
          json_text(result, teams, machine), cases};
}

BenchReport report_of_scaling(const KernelResult& result, const Teams& teams, const std::vector<BenchmarkCase>& cases) {
  const Machine machine = this_machine();
  constexpr std::size_t kTextColumns = 4;
  return {table_of(result, scaling_rows(result.rows), teams, machine, kTextColumns), csv_of(result),
          json_text(result, teams, machine), cases};
}

}  // namespace fascia::app
