#include "victorious/apps/serve/event_hub.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(EventHub, ListenersGetTheLatestOfEachNameThenWhatFollows) {
  const auto hub = std::make_shared<EventHub>();
  hub->Publish("jobs", "1");
  hub->Publish("index", "2");
  hub->Publish("jobs", "3");
  const auto feed = hub->Listen();
  EXPECT_EQ(hub->listeners(), 1);
  EXPECT_EQ(feed->Take(), "id: 2\nevent: index\ndata: 2\n\nid: 3\nevent: jobs\ndata: 3\n\n");
  EXPECT_EQ(feed->Take(), "");
  hub->Publish("jobs", "4");
  hub->Publish("jobs", "5");
  EXPECT_EQ(feed->Take(), "id: 4\nevent: jobs\ndata: 4\n\nid: 5\nevent: jobs\ndata: 5\n\n");
}

TEST(EventHub, SlowListenersGetWhatHoldsNow) {
  const auto hub = std::make_shared<EventHub>();
  const auto feed = hub->Listen();
  hub->Publish("index", "early");
  EXPECT_THAT(feed->Take(), HasSubstr("early"));
  hub->Publish("index", "late");
  for (int i = 0; i < 1000; ++i) hub->Publish("jobs", std::to_string(i));
  const std::string text = feed->Take();
  EXPECT_THAT(text, HasSubstr("data: late"));
  EXPECT_THAT(text, HasSubstr("data: 999"));
  EXPECT_THAT(text, Not(HasSubstr("data: 998")));
}

TEST(EventHub, ListenersEnd) {
  const auto hub = std::make_shared<EventHub>();
  hub->Listen().reset();
  EXPECT_EQ(hub->listeners(), 0);
}

}  // namespace
}  // namespace victorious
