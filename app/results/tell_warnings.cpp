#include "app/results/tell_warnings.hpp"

#include "app/run/messages.hpp"

namespace fascia::app {

void tell(Warnings& warnings, const std::filesystem::path& scene) {
  for (const Warning& w : warnings.take_new()) {
    if (w.place && w.place->line > 0)
      say("{}:{}:{}: warning: {}\n", w.place->file, w.place->line, w.place->column, w.summary());
    else
      say("{}: warning: {}\n", scene.string(), w.summary());
  }
}

}  // namespace fascia::app
