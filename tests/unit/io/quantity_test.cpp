#include "io/quantity.hpp"

#include <gtest/gtest.h>

namespace fascia::io::quantity_test {
namespace {

TEST(Quantity, UnitsMakeNumbersReadable) {
  const auto unit = [](double largest, const char* si) { return readable_unit(largest, si).unit; };
  EXPECT_EQ(unit(1262, "Pa"), "kPa");
  EXPECT_EQ(unit(999, "Pa"), "Pa");
  EXPECT_EQ(unit(1e6, "Pa"), "MPa");
  EXPECT_EQ(unit(0.0275, "m"), "mm");
  EXPECT_EQ(unit(3e-6, "m"), "µm");
  EXPECT_EQ(unit(2300, "J/m3"), "kJ/m³");
  EXPECT_EQ(unit(0, "Pa"), "Pa");
  EXPECT_EQ(unit(0.3, "1"), "");
  EXPECT_EQ(unit(3e-5, "1"), "1e-6");
  EXPECT_DOUBLE_EQ(readable_unit(1262, "Pa").factor, 1e-3);
  EXPECT_DOUBLE_EQ(readable_unit(3e-5, "1").factor, 1e6);
  EXPECT_EQ(readable_unit(1e-40, "m").unit, "fm");
}

TEST(Quantity, TicksAreRoundAndWithinTheRange) {
  const Ticks ticks = round_ticks(0.0004, 1.26, 7);
  EXPECT_DOUBLE_EQ(ticks.step, 0.2);
  ASSERT_EQ(ticks.values.size(), 6u);
  EXPECT_DOUBLE_EQ(ticks.values.front(), 0.2);
  EXPECT_NEAR(ticks.values.back(), 1.2, 1e-12);
  for (const double high : {1.0, 1.1, 1.9, 2.0, 3.3, 4.5, 5.0, 7.7, 9.99})
    for (const int count : {1, 3, 5, 7}) {
      const Ticks some = round_ticks(0, high, count);
      EXPECT_LE(some.values.size(), static_cast<std::size_t>(count) + 1) << high << " " << count;
      EXPECT_GE(some.step * count, high * (1 - 1e-9)) << high << " " << count;
    }
  EXPECT_EQ(round_ticks(-1, 1, 4).values.size(), 5u);
}

TEST(Quantity, NumbersHaveTheDigitsThatTheirStepNeeds) {
  EXPECT_EQ(number_text(0.6, 0.2), "0.6");
  EXPECT_EQ(number_text(1200, 200), "1200");
  EXPECT_EQ(number_text(-1e-17, 0.5), "0");
  EXPECT_EQ(number_text(1.2618, 0.02), "1.26");
  EXPECT_EQ(number_text(0.0003, 0.02), "0");
  EXPECT_EQ(short_number_text(1, 0.02), "1");
  EXPECT_EQ(short_number_text(1200, 20), "1200");
  EXPECT_EQ(short_number_text(27.5, 0.5), "27.5");
}

TEST(Quantity, LengthsAreRoundInTheUnitOfTheirSize) {
  EXPECT_DOUBLE_EQ(round_below(0.0437), 0.02);
  EXPECT_DOUBLE_EQ(round_below(0.05), 0.05);
  EXPECT_EQ(length_text(0.05), "5 cm");
  EXPECT_EQ(length_text(0.5), "50 cm");
  EXPECT_EQ(length_text(0.001), "1 mm");
  EXPECT_EQ(length_text(2e-4), "200 µm");
  EXPECT_EQ(length_text(20), "20 m");
  EXPECT_EQ(length_text(500), "500 m");
  EXPECT_EQ(length_text(1000), "1 km");
  EXPECT_EQ(length_text(5e6), "5000 km");
}

TEST(Quantity, TimesAndFrequencies) {
  EXPECT_EQ(quantity_text(0, "s"), "0 s");
  EXPECT_EQ(quantity_text(0.04, "s"), "0.04 s");
  EXPECT_EQ(quantity_text(0.004, "s"), "4 ms");
  EXPECT_EQ(quantity_text(3600, "s"), "3600 s");
  EXPECT_EQ(quantity_text(12.4, "Hz"), "12.4 Hz");
  EXPECT_EQ(quantity_text(1234.5678, "Hz"), "1.235 kHz");
  EXPECT_EQ(quantity_text(12345.6, "s"), "12346 s");
  EXPECT_EQ(quantity_text(12345.6, "s", 0.1), "12345.6 s");
  EXPECT_EQ(quantity_text(10.001, "s", 0.001), "10.001 s");
  EXPECT_EQ(quantity_text(0.3 + 1e-16, "s", 0.1), "0.3 s");
  EXPECT_EQ(quantity_text(0.00410002, "s", 1e-8), "4.10002 ms");
}

TEST(Quantity, FieldsHaveWordsAndUnits) {
  EXPECT_EQ(name_of_field("von_mises").words, "von Mises stress");
  EXPECT_EQ(name_of_field("energy_density").unit, "J/m3");
  EXPECT_EQ(name_of_field("my_field").words, "my field");
  EXPECT_EQ(name_of_field("my_field").unit, "");
  for (const char* field : {"displacement", "von_mises", "energy_density"})
    EXPECT_TRUE(name_of_field(field).of_motion) << field;
  for (const char* field : {"thickness", "rest_position", "part"})
    EXPECT_FALSE(name_of_field(field).of_motion) << field;
}

}  // namespace
}  // namespace fascia::io::quantity_test
