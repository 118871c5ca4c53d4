#include "app/report/html_page.hpp"
#include "app/verify/report.hpp"
#include "io/files.hpp"

#include <fmt/ranges.h>

#include <cmath>
#include <map>

namespace fascia::app {
namespace {

ResultState state_of(Verdict verdict) {
  return verdict == Verdict::passed   ? ResultState::right
         : verdict == Verdict::failed ? ResultState::wrong
                                      : ResultState::none;
}

std::string sentence_of(const Verification& v, const Counts& counts) {
  std::string text = fmt::format("{} of {} cases passed", counts.passed, counts.all());
  if (counts.failed > 0) text += fmt::format(", {} failed", counts.failed);
  if (counts.skipped > 0) text += fmt::format(", {} were skipped", counts.skipped);
  text +=
      fmt::format(". {} of {} repeated runs are equal bit for bit.", counts.repeated - counts.unequal, counts.repeated);
  if (v.long_left > 0) text += fmt::format(" {} long runs were left out; --full takes them.", v.long_left);
  return text;
}

ReportTable all_cases(const Verification& v, const std::vector<std::string>& anchors) {
  ReportTable table{fmt::format("{} cases", count(v).all()),
                    {{"case", ""},
                     {"verdict", ""},
                     {"value", "", true},
                     {"reference", "", true},
                     {"unit", ""},
                     {"error", "of what is allowed", true},
                     {"time", "s", true},
                     {"features", ""}},
                    {}};
  for (std::size_t r = 0; r < v.runs.size(); ++r)
    for (std::size_t i = 0; i < v.runs[r].cases.size(); ++i) {
      const VerificationCase& c = v.runs[r].cases[i];
      const CaseOutcome& outcome = v.outcomes[r].cases[i];
      ReportCell name = c.name;
      name.anchor = anchors[r];
      const std::optional<double> used = outcome.value && c.allowed.error > 0
                                             ? std::optional(std::abs(outcome.error) / c.allowed.error)
                                             : std::nullopt;
      table.rows.push_back({name, state_cell(state_of(outcome.verdict), name_of(outcome.verdict)),
                            number_cell(outcome.value, 6), number_cell(c.value, 6), c.unit, number_cell(used, 2),
                            number_cell(v.outcomes[r].seconds, 3),
                            fmt::format("{}", fmt::join(v.runs[r].features, " "))});
    }
  return table;
}

/// Every feature, with how its cases ended.
ReportTable features(const Verification& v) {
  std::map<std::string, Counts> all;
  for (std::size_t r = 0; r < v.runs.size(); ++r)
    for (const std::string& feature : v.runs[r].features)
      for (const CaseOutcome& c : v.outcomes[r].cases) {
        Counts& counts = all[feature];
        ++(c.verdict == Verdict::passed   ? counts.passed
           : c.verdict == Verdict::failed ? counts.failed
                                          : counts.skipped);
      }
  ReportTable table{
      "Cases by feature", {{"feature", ""}, {"passed", "", true}, {"failed", "", true}, {"skipped", "", true}}, {}};
  for (const auto& [feature, c] : all) {
    const auto number = [](std::size_t n) { return number_cell(static_cast<double>(n)); };
    table.rows.push_back({feature, number(c.passed), number(c.failed), number(c.skipped)});
  }
  return table;
}

ReportTable cases_of(const VerificationRun& run, const RunOutcome& outcome) {
  ReportTable table{"",
                    {{"case", ""},
                     {"verdict", ""},
                     {"value", ""},
                     {"reference", ""},
                     {"error", ""},
                     {"allowed", ""},
                     {"source", ""},
                     {"what limits the error", ""}},
                    {}};
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const VerificationCase& c = run.cases[i];
    const CaseOutcome& o = outcome.cases[i];
    const std::string uncertain = c.uncertainty > 0 ? fmt::format(" ± {:.2g} %", 100 * c.uncertainty) : "";
    const std::string reason = o.reason.empty() ? "" : ": " + o.reason;
    table.rows.push_back({c.title, state_cell(state_of(o.verdict), name_of(o.verdict) + reason),
                          o.value ? with_unit(*o.value, c.unit) : "–", with_unit(c.value, c.unit) + uncertain,
                          o.value ? error_text(o.error, c.allowed, c.unit) : "–",
                          error_text(c.allowed.error, c.allowed, c.unit), c.source, c.why});
  }
  return table;
}

void add_certificate(HtmlPage& page, const Verification& v) {
  const Certificate& c = v.certificate;
  const Machine& m = c.machine;
  ReportTable table{"", {{"what", ""}, {"", ""}}, {}};
  const auto add = [&](const std::string& what, const std::string& value) {
    if (!value.empty()) table.rows.push_back({what, value});
  };
  add("version", m.fascia);
  add("commit", m.commit);
  for (const auto& [file, digest] : c.files) add("SHA-256 of " + file, digest);
  add("compiler", m.compiler);
  add("flags", m.flags + ", " + m.build);
  for (const auto& [name, version] : m.libraries) add(name, version);
  add("backends", m.backends);
  add("backend of these runs", v.settings.backend.value_or("of each scene"));
  add("processor", m.cpu);
  add("compiled for", c.processor_level);
  add("threads", fmt::format("{} of the machine; {} runs at once, each on one", m.threads, v.settings.jobs));
  for (const std::string& gpu : m.gpu) add("GPU", fmt::format("{}, driver {}", gpu, m.driver));
  add("memory", fmt::format("{:.3g} GB", m.memory / 1e9));
  add("system", m.system);
  add("host", m.host);
  add("begun", m.date);
  page.table(table);
  page.command(c.command);
}

ReportTable determinism(const Verification& v) {
  ReportTable table{"", {{"run", ""}, {"made again on", ""}, {"result", ""}}, {}};
  for (std::size_t r = 0; r < v.runs.size(); ++r)
    for (const Repetition& again : v.outcomes[r].repetitions)
      table.rows.push_back({v.runs[r].name,
                            fmt::format("{} {}", again.threads, again.threads == 1 ? "thread" : "threads"),
                            again.equal ? state_cell(ResultState::right, "equal bit for bit")
                                        : state_cell(ResultState::wrong, "differs: " + again.difference)});
  return table;
}

/// The pictures of a run, which its directory holds.
void add_pictures(HtmlPage& page, const VerificationRun& run, const std::filesystem::path& directory) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(directory, none))
    if (entry.path().extension() == ".png") page.picture(io::read_file(entry.path()), run.title);
}

/// @param anchors  of the runs: those of the last call are read, those of this one are written
std::string page_with(const Verification& v, const VerifyDirectory& directory, std::vector<std::string>& anchors) {
  const Counts counts = count(v);
  HtmlPage page(fmt::format("fascia {}: verification", v.certificate.machine.fascia));
  if (counts.good() && !v.interrupted)
    page.paragraph(sentence_of(v, counts));
  else
    page.notice((v.interrupted ? "Interrupted. " : "") + sentence_of(v, counts));
  page.heading("Certificate");
  add_certificate(page, v);
  page.heading("Determinism");
  page.paragraph(
      "These runs were made again, on one thread and on all of the machine's. Every number of every table and field is "
      "compared.");
  page.table(determinism(v));
  page.heading("All cases");
  page.table(all_cases(v, anchors));
  page.heading("Features");
  page.table(features(v));
  std::string topic;
  for (std::size_t r = 0; r < v.runs.size(); ++r) {
    const VerificationRun& run = v.runs[r];
    if (run.topic != topic) page.heading(run.heading);
    topic = run.topic;
    anchors[r] = page.heading(run.title, 3);
    page.command(v.outcomes[r].command);
    page.table(cases_of(run, v.outcomes[r]));
    if (v.settings.pictures) add_pictures(page, run, directory.run(run.name));
  }
  page.footer(fmt::format("fascia {}, {}", v.certificate.machine.fascia, v.certificate.machine.date));
  return page.text();
}

}  // namespace

std::string html_of(const Verification& v, const VerifyDirectory& directory) {
  std::vector<std::string> anchors(v.runs.size());
  page_with(v, directory, anchors);  // for the anchors, to which the table before them leads
  return page_with(v, directory, anchors);
}

}  // namespace fascia::app
