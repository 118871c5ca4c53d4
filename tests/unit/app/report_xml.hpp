#pragma once

#include <vtkXMLParser.h>

#include <map>
#include <string>
#include <vector>

/// What an XML text holds.
namespace fascia::report_xml {

struct Element {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;  ///< its own, entities resolved
};

/// Collects elements in the order of their begins.
class Reader : public vtkXMLParser {
 public:
  static Reader* New() {
    auto* reader = new Reader;
    reader->InitializeObjectBase();
    return reader;
  }
  std::vector<Element> elements;
  bool well_formed = true;

 protected:
  void StartElement(const char* name, const char** attributes) override {
    open_.push_back(elements.size());
    elements.push_back({name, {}, ""});
    for (; attributes[0] != nullptr; attributes += 2) elements.back().attributes[attributes[0]] = attributes[1];
  }
  void EndElement(const char*) override { open_.pop_back(); }
  void CharacterDataHandler(const char* data, int length) override {
    elements[open_.back()].text.append(data, static_cast<std::size_t>(length));
  }
  void ReportXmlParseError() override { well_formed = false; }

 private:
  std::vector<std::size_t> open_;
};

/// Its elements; none where it is not well-formed.
inline std::vector<Element> elements_of(const std::string& xml) {
  Reader* reader = Reader::New();
  const bool parsed = reader->Parse(xml.c_str(), static_cast<unsigned int>(xml.size())) != 0;
  const std::vector<Element> elements = parsed && reader->well_formed ? reader->elements : std::vector<Element>{};
  reader->Delete();
  return elements;
}

/// Of those with this name and this class.
inline std::vector<Element> of_class(const std::vector<Element>& elements, const std::string& name,
                                     const std::string& wanted) {
  std::vector<Element> found;
  for (const Element& e : elements) {
    const auto classes = e.attributes.find("class");
    const bool has =
        classes != e.attributes.end() && (" " + classes->second + " ").find(" " + wanted + " ") != std::string::npos;
    if (e.name == name && has) found.push_back(e);
  }
  return found;
}

}  // namespace fascia::report_xml
