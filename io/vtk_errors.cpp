#include "io/vtk_errors.hpp"

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include <cctype>
#include <string_view>

namespace fascia::io {
namespace {

/// Keeps the first error or warning and drops all else: a warning tells of data that a reader left out.
class FirstErrorWindow : public vtkOutputWindow {
 public:
  static FirstErrorWindow* New();
  vtkTypeMacro(FirstErrorWindow, vtkOutputWindow)

      void DisplayText(const char*) override {}
  void DisplayErrorText(const char* text) override { keep(text); }
  void DisplayWarningText(const char* text) override { keep(text); }
  void DisplayGenericWarningText(const char* text) override { keep(text); }
  void DisplayDebugText(const char*) override {}

  const std::string& first() const { return first_; }

 private:
  void keep(const char* text) {
    const std::string_view message(text);
    const bool generic = message.starts_with("Generic Warning");  // most of these are of no harm
    if (first_.empty() && (!generic || message.find("Error reading") != message.npos)) first_ = message;
  }

  std::string first_;
};

vtkStandardNewMacro(FirstErrorWindow);

}  // namespace

VtkErrors::VtkErrors() : former_(vtkOutputWindow::GetInstance()), window_(vtkSmartPointer<FirstErrorWindow>::New()) {
  vtkOutputWindow::SetInstance(window_);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkErrors::~VtkErrors() { vtkOutputWindow::SetInstance(former_); }

std::string VtkErrors::first() const {
  const std::string& text = static_cast<const FirstErrorWindow*>(window_.Get())->first();
  // "ERROR: In FILE, line N\nCLASS (ADDRESS): what happened"; a generic warning names no class
  std::size_t begin = text.find("): ");
  if (begin != std::string::npos)
    begin += 3;
  else
    begin = text.starts_with("Generic Warning") ? text.find('\n') + 1 : 0;
  std::string line;
  for (const char c : text.substr(begin)) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (blank && (line.empty() || line.back() == ' ')) continue;
    line += blank ? ' ' : (c >= ' ' && c <= '~' ? c : '?');
    if (line.size() >= 200) break;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  // Addresses differ from run to run.
  for (std::size_t at = line.find("(0x"); at != std::string::npos; at = line.find("(0x")) {
    const std::size_t close = line.find(')', at);
    line.erase(at, close == std::string::npos ? close : close - at + 1);
  }
  return line;
}

}  // namespace fascia::io
