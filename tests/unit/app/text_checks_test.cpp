#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

namespace fascia::app::text_checks_test {
namespace {

using test::beam_with;
using test::errors_of;
using test::errors_of_beam;

constexpr const char* kConvert = "save it as UTF-8, or convert it: iconv -f ";

TEST(TextChecks, AByteOrderMarkChangesNothing) {
  EXPECT_EQ(errors_of("\xEF\xBB\xBF" + std::string(test::beam)), "");
  EXPECT_EQ(errors_of("\xEF\xBB\xBF" + beam_with("0.3", "0.7")),
            "a.toml:3:11: materials.soft.poisson: 0.7 is out of range; must be above -1 and below 0.5");
}

std::string wide(bool big_endian) {
  std::string text;
  for (const char c : test::beam) text += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return text;
}

TEST(TextChecks, Utf16IsRefusedWithTheRemedy) {
  const auto message = [](const std::string& name) {
    return "a.toml:1:1: toml: the text is " + name + " and must be UTF-8; " + kConvert + name +
           " -t UTF-8 OLD.toml > NEW.toml";
  };
  EXPECT_EQ(errors_of("\xFF\xFE" + wide(false)), message("UTF-16"));
  EXPECT_EQ(errors_of("\xFE\xFF" + wide(true)), message("UTF-16"));
  EXPECT_EQ(errors_of(wide(false)), message("UTF-16LE"));
  EXPECT_EQ(errors_of(wide(true)), message("UTF-16BE"));
}

TEST(TextChecks, BytesThatAreNoUtf8AreRefusedWhereTheyStand) {
  const std::string remedy = std::string("it may be Latin-1; ") + kConvert + "LATIN1 -t UTF-8 OLD.toml > NEW.toml";
  EXPECT_EQ(errors_of("# \xC3\xA9\ntitle = \"Mus\xE9"
                      "e\"\n"),
            "a.toml:2:13: toml: the byte 0xE9 is no UTF-8; " + remedy);
  for (const char* wrong : {"\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xE2\x82", "\x80", "\xFE"})
    EXPECT_NE(errors_of_beam("title = \"" + std::string(wrong) + "\"\n").find("is no UTF-8"), std::string::npos);
  EXPECT_EQ(test::parse_beam("[world]\n").title, "");
  EXPECT_EQ(test::parse("title = \"Mus\xC3\xA9"
                        "e \xE2\x82\xAC \xF0\x9F\xA6\xB4\"\n" +
                        std::string(test::beam))
                .title,
            "Mus\xC3\xA9"
            "e \xE2\x82\xAC \xF0\x9F\xA6\xB4");
}

TEST(TextChecks, OverridesAreUtf8Too) {
  EXPECT_EQ(errors_of_beam("", {"title=Mus\xE9"
                                "e"}),
            "--set:1:10: the byte 0xE9 is no UTF-8; it may be Latin-1; write it in UTF-8");
}

TEST(TextChecks, AnUnquotedUnitIsNamed) {
  EXPECT_EQ(errors_of(beam_with("\"40 kPa\"", "5 kPa")),
            "a.toml:2:9: toml: a value with a unit stands in quotes: young = \"5 kPa\"");
  EXPECT_EQ(errors_of(beam_with("\"40 kPa\"", "5kPa # soft")),
            "a.toml:2:9: toml: a value with a unit stands in quotes: young = \"5kPa\"");
  EXPECT_EQ(errors_of(beam_with("\"40 kPa\"", "-1.5e-3 \xC2\xB5m/s2")),
            "a.toml:2:9: toml: a value with a unit stands in quotes: young = \"-1.5e-3 \xC2\xB5m/s2\"");
  EXPECT_EQ(errors_of(beam_with("max = [4, 1, 1]", "max = [4, 100 cm, 1]")),
            "a.toml:6:47: toml: a value with a unit stands in quotes: \"100 cm\"");
  EXPECT_EQ(errors_of_beam("points = { a = \"3 mm\", b = 3 mm }\n"),
            "a.toml:10:28: toml: a value with a unit stands in quotes: b = \"3 mm\"");
  EXPECT_EQ(errors_of_beam("list = [\n  1,\n  2 mm,\n]\n"),
            "a.toml:12:3: toml: a value with a unit stands in quotes: \"2 mm\"");
}

TEST(TextChecks, OtherMistakesKeepTheirOwnMessage) {
  for (const char* line :
       {"a = 0x1F b\n", "a = 1 = 2\n", "a = 1979-05-27T\n", "a = tru\n", "5 mm = 3\n", "a = 3 # 5 mm\nb = ?\n"})
    EXPECT_NE(errors_of_beam(line).find("must be TOML 1.0"), std::string::npos) << errors_of_beam(line);
}

TEST(TextChecks, NamesOfFilesFitWhatTheyName) {
  const auto errors = [](const std::string& name) -> std::string {
    try {
      parse_scene_text(test::beam, name, {});
      return "";
    } catch (const SceneError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(errors(std::string(251, 'n') + ".toml"), "");
  EXPECT_NE(errors(std::string(252, 'n') + ".toml").find("the file's name has 252 bytes"), std::string::npos);
  EXPECT_NE(errors("Mus\xE9"
                   "e.toml")
                .find("the file's name is no UTF-8"),
            std::string::npos);
  const std::string body = beam_with("[bodies.beam]", "[bodies." + std::string(255, 'b') + "]");
  EXPECT_NE(errors_of(body).find("cannot name a file; use up to 100 letters"), std::string::npos) << errors_of(body);
}

}  // namespace
}  // namespace fascia::app::text_checks_test
