#pragma once

namespace fascia::app {

/// How a run, a case or a cell of a map ended.
enum class ResultState {
  none,      ///< not run
  right,     ///< within what is allowed
  refused,   ///< before anything was computed, with a reason
  stopped,   ///< while computing, with a reason
  doubtful,  ///< computed, and not known to be right
  wrong      ///< computed, and beyond what is allowed
};

/// "right", ..., "not run"
const char* state_name(ResultState state);
/// Its class in a page's style: the same, but "none".
const char* state_class(ResultState state);
/// A sign that reads without colour: "✓", "R", "S", "?", "✗", "·".
const char* state_sign(ResultState state);

}  // namespace fascia::app
