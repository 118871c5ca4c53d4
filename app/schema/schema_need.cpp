#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

Key error_key() {
  return key("error", number("1", inside(0, 1)),
             "The largest relative error of the probe, by its estimate: discretisation, time steps and solver "
             "together, over all saved times.");
}

Key probe_key(const char* otherwise) {
  return key("probe", text("the name of a probe"), "What `error` is of.").defaults(otherwise);
}

}  // namespace

Key need_schema() {
  return key(
      "need",
      table({error_key(), probe_key("the largest displacement of each body"),
             key("step", number("s", above(0)),
                 "Of dynamics: the 99th percentile of the time that a step takes on this machine."),
             key("memory", number("byte", above(0)), "The most memory that the run may take."),
             key("study", text("the directory of a study"),
                 "Where `fascia study` has written: the choice is made among the runs of that study, of whatever it "
                 "varied, and none is tried. `error` is then of the study's measures of `probe`, or of all of them.")}),
      "What the results must be worth. `fascia run` then chooses what the scene leaves out: frames or cells, "
      "the order of elements, the kind of frames, the time step, and beside a `duration` the kind of time steps. "
      "The manual has a chapter on needs.");
}

Key body_need_key() {
  return key("need", table({error_key().needed(), probe_key("the largest displacement of the body")}),
             "What the results of this body must be worth; beside `need`, or alone.");
}

}  // namespace fascia::app
