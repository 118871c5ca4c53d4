#include "app/report/result_state.hpp"

namespace fascia::app {

const char* state_name(ResultState state) {
  switch (state) {
    case ResultState::right:
      return "right";
    case ResultState::refused:
      return "refused";
    case ResultState::stopped:
      return "stopped";
    case ResultState::doubtful:
      return "doubtful";
    case ResultState::wrong:
      return "wrong";
    case ResultState::none:
      break;
  }
  return "not run";
}

const char* state_class(ResultState state) { return state == ResultState::none ? "none" : state_name(state); }

const char* state_sign(ResultState state) {
  switch (state) {
    case ResultState::right:
      return "✓";
    case ResultState::refused:
      return "R";
    case ResultState::stopped:
      return "S";
    case ResultState::doubtful:
      return "?";
    case ResultState::wrong:
      return "✗";
    case ResultState::none:
      break;
  }
  return "·";
}

}  // namespace fascia::app
