#include "victorious/jobs/track/box_sighting.h"

#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

TEST(BoxSighting, UnknownIsNull) {
  const std::vector<BoxSighting> sightings = {
      {.frame = 3, .time_s = 0.3, .box = {1, 2, 3, 4}, .score = 0.5},
      {.box_index = 1, .frame = 4, .time_s = 0.4, .box = {1, 2, 3, 4}, .score = 0.9, .matches = 12}};
  const std::vector<UserBox> boxes = {{{1, 2, 3, 4}, 0.0, "vehicle/car"}, {{1, 2, 3, 4}, 0.0}};
  const std::vector<std::string> videos = {"flight.mkv"};
  const std::string text = ToJsonLines(sightings, videos, boxes);
  const auto first = nlohmann::json::parse(text.substr(0, text.find('\n')));
  const auto second = nlohmann::json::parse(text.substr(text.find('\n') + 1));
  EXPECT_EQ(first["source"], "tracked");
  EXPECT_TRUE(first["matches"].is_null());
  EXPECT_EQ(second["source"], "recognised");
  EXPECT_EQ(second["matches"], 12);
  EXPECT_EQ(second["model"], "box-2");
  EXPECT_EQ(first["type"], "vehicle/car");
  EXPECT_TRUE(second["type"].is_null());
  for (const char* key : {"latitude_deg", "longitude_deg", "altitude_m", "ce90_m", "le90_m", "speed_m_s"}) {
    EXPECT_TRUE(first.at(key).is_null()) << key;
  }
}

}  // namespace
}  // namespace victorious
