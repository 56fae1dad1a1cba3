#include "victorious/place/associate/link_constraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/place/associate/associate_objects.h"
#include "victorious/place/associate/linked_objects.h"
#include "victorious/place/associate/simulated_tracklet_test.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

TrackletLink One(std::int64_t first, std::int64_t second) { return {.first = first, .second = second, .is_one = true}; }
TrackletLink Two(std::int64_t first, std::int64_t second) {
  return {.first = first, .second = second, .is_one = false};
}

bool AreApart(const LinkConstraints& constraints, std::int64_t first, std::int64_t second) {
  const ObservedTracklet of_first{.record = {.id = first}};
  const ObservedTracklet of_second{.record = {.id = second}};
  const ObservedTracklet* const some = &of_first;
  const ObservedTracklet* const others = &of_second;
  return constraints.CannotLink(std::span(&some, 1), std::span(&others, 1));
}

TEST(LinkConstraints, FollowFromOneAnother) {
  const std::vector<TrackletLink> links = {One(4, 2), One(4, 7), Two(7, 9), One(9, 10)};
  const LinkConstraints constraints(links);
  for (const std::int64_t tracklet : {2, 4, 7}) {
    EXPECT_EQ(constraints.GroupOf(tracklet), 2);
    for (const std::int64_t other : {9, 10}) {
      EXPECT_TRUE(AreApart(constraints, tracklet, other));
      EXPECT_TRUE(AreApart(constraints, other, tracklet));
    }
  }
  EXPECT_FALSE(AreApart(constraints, 9, 10));
  EXPECT_EQ(constraints.GroupOf(3), 3);
  EXPECT_FALSE(AreApart(constraints, 3, 2));
}

TEST(LinkConstraints, TheLaterOfTwoThatContradictCounts) {
  const std::vector<TrackletLink> parted = {One(1, 2), One(2, 3), Two(1, 3)};
  EXPECT_TRUE(AreApart(LinkConstraints(parted), 1, 3));
  EXPECT_EQ(LinkConstraints(parted).GroupOf(3), 2);
  const std::vector<TrackletLink> joined = {Two(1, 3), One(1, 2), One(2, 3)};
  EXPECT_FALSE(AreApart(LinkConstraints(joined), 1, 3));
  EXPECT_EQ(LinkConstraints(joined).GroupOf(3), 1);
}

// Objects of tracklets.
std::vector<ObjectRecord> Associate(const std::vector<SimulatedTracklet>& simulated,
                                    const std::vector<TrackletLink>& links) {
  std::vector<ObservedTracklet> tracklets;
  for (const SimulatedTracklet& one : simulated) {
    tracklets.push_back(SimulateTracklet(one));
    tracklets.back().start_utc_us = 1'700'000'000'000'000 + 100'000'000 * one.video;
  }
  SearchCounts searches;
  for (std::int64_t video = 0; video < 5; ++video) searches.Add(video, 100, {});
  return AssociateTracklets(std::move(tracklets), searches, {}, LinkConstraints(links));
}

std::vector<std::vector<std::int64_t>> MembersOf(const std::vector<ObjectRecord>& objects) {
  std::vector<std::vector<std::int64_t>> members;
  for (const ObjectRecord& object : objects) members.push_back(object.tracklets);
  return members;
}

Eigen::Vector3d PlaceOf(const ObjectRecord& object) {
  return TangentPlane(kOrigin).EnuFromGeodetic(object.place->point);
}

const std::vector<SimulatedTracklet> kThreeTimes = {
    {.id = 1}, {.id = 2, .first_frame = 50}, {.id = 3, .video = 2, .first_frame = 20}};

TEST(LinkedTracklets, OneObjectIsParted) {
  ASSERT_THAT(MembersOf(Associate(kThreeTimes, {})), ElementsAre(ElementsAre(1, 2, 3)));
  EXPECT_THAT(MembersOf(Associate(kThreeTimes, {Two(1, 2)})), ElementsAre(ElementsAre(1), ElementsAre(2, 3)))
      << "in one flight; the third is nearer to the second";
  EXPECT_THAT(MembersOf(Associate(kThreeTimes, {Two(2, 3)})), ElementsAre(ElementsAre(1, 2), ElementsAre(3)))
      << "in two flights";
  EXPECT_THAT(MembersOf(Associate(kThreeTimes, {One(1, 3), Two(1, 2)})),
              ElementsAre(ElementsAre(1, 3), ElementsAre(2)));
}

// They stand at one place, as two vehicles that parked there one after the other.
TEST(LinkedTracklets, NeitherOfThePartsIsRejected) {
  std::vector<SimulatedTracklet> cad = kThreeTimes;
  for (SimulatedTracklet& one : cad) one.body_m = Eigen::Vector3d(4, 2, 1.5);
  for (const ObjectRecord& object : Associate(cad, {Two(1, 2)})) {
    EXPECT_EQ(object.rejected, "") << object.id;
    EXPECT_TRUE(object.place) << object.id;
  }
}

// The third shares frames with the second, and stands where the first does.
TEST(LinkedTracklets, AMergeWithAnotherDoesNotKeepThemApart) {
  const std::vector<SimulatedTracklet> seen = {
      {.id = 1}, {.id = 2, .place_enu = {0, 60, 1}, .first_frame = 50}, {.id = 3, .first_frame = 60}};
  ASSERT_THAT(MembersOf(Associate(seen, {})), ElementsAre(ElementsAre(1, 3), ElementsAre(2)));
  EXPECT_THAT(MembersOf(Associate(seen, {One(1, 2)})), ElementsAre(ElementsAre(1, 2), ElementsAre(3)));
}

TEST(LinkedTracklets, APlaceThatAgreesIsThatWithTheSmallerError) {
  const std::vector<SimulatedTracklet> seen = {{.id = 1, .frames = 60}, {.id = 2, .first_frame = 80, .frames = 6}};
  const auto objects = Associate(seen, {Two(1, 2)});
  ASSERT_EQ(objects.size(), 2U);
  ASSERT_LT(objects[0].place->ce90_m, objects[1].place->ce90_m);
  EXPECT_TRUE(IsPreferred(objects[0], {}, objects[1], {}, {}));
}

TEST(LinkedTracklets, ObjectsFarApartAreJoinedAndStandWhereTheLastWas) {
  const std::vector<SimulatedTracklet> moved = {{.id = 1},
                                                {.id = 2, .place_enu = {0, 60, 1}, .first_frame = 50},
                                                {.id = 3, .video = 2, .place_enu = {-30, 0, 1}}};
  ASSERT_EQ(Associate(moved, {}).size(), 3U);
  const auto of_one_flight = Associate(moved, {One(1, 2)});
  ASSERT_THAT(MembersOf(of_one_flight), ElementsAre(ElementsAre(1, 2), ElementsAre(3)));
  EXPECT_LT((PlaceOf(of_one_flight[0]) - Eigen::Vector3d(0, 60, 1)).norm(), 1);
  EXPECT_EQ(of_one_flight[0].place_rejected, "");
  EXPECT_THAT(of_one_flight[0].against, ::testing::Contains("joined by a person: seen 60 m apart"));
  EXPECT_EQ(of_one_flight[0].rejected, "");
  const auto of_both = Associate(moved, {One(1, 2), One(1, 3)});
  ASSERT_THAT(MembersOf(of_both), ElementsAre(ElementsAre(1, 2, 3)));
  EXPECT_LT((PlaceOf(of_both[0]) - Eigen::Vector3d(-30, 0, 1)).norm(), 1) << "the second video is of a later hour";
  EXPECT_GE(*of_both[0].object_score, *Associate(moved, {})[0].object_score);
}

TEST(LinkedTracklets, WithoutTelemetryTheyAreJoinedWithoutAPlace) {
  const ObservedTracklet a{.record = {.id = 1, .video = 1, .model = 1}, .frames = {0, 1}};
  const ObservedTracklet b{.record = {.id = 2, .video = 2, .model = 1}, .frames = {0, 1}};
  const std::vector<TrackletLink> links = {One(1, 2)};
  const auto objects = AssociateTracklets({a, b}, {}, {}, LinkConstraints(links));
  EXPECT_THAT(MembersOf(objects), ElementsAre(ElementsAre(1, 2)));
  EXPECT_FALSE(objects[0].place);
}

TEST(LinkedTracklets, ThoseOfOneFrameStayTwo) {
  const ObservedTracklet a{.record = {.id = 1, .video = 1, .model = 1}, .frames = {0, 1}};
  const ObservedTracklet b{.record = {.id = 2, .video = 1, .model = 1}, .frames = {1, 2}};
  const std::vector<TrackletLink> links = {One(1, 2)};
  EXPECT_EQ(AssociateTracklets({a, b}, {}, {}, LinkConstraints(links)).size(), 2U);
}

}  // namespace
}  // namespace victorious
