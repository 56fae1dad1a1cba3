#include "victorious/object/model/relit_view_cache.h"

#include <cstddef>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

using Kind = RelitViewCache::Kind;

RelitViewCache::Key KeyOf(std::size_t view) { return {.model = 0, .kind = Kind::kTemplate, .view = view, .light = 0}; }

TEST(RelitViewCache, KeepsOneItemPerKey) {
  RelitViewCache cache;
  EXPECT_NE(cache.AddModel(), cache.AddModel());
  const auto item = cache.FindOrAdd<int>(KeyOf(1));
  EXPECT_EQ(*item, 0);
  *item = 7;
  EXPECT_EQ(*cache.FindOrAdd<int>(KeyOf(1)), 7);
  EXPECT_NE(cache.FindOrAdd<int>(KeyOf(2)), item);
  RelitViewCache::Key half = KeyOf(1);
  half.kind = Kind::kHalfTemplate;
  EXPECT_NE(cache.FindOrAdd<int>(half), item);
}

TEST(RelitViewCache, EvictsTheLeastRecentlyUsedItemsOfKnownSize) {
  RelitViewCache cache(100);
  const auto unknown = cache.FindOrAdd<int>(KeyOf(9));
  std::vector<std::shared_ptr<int>> items;
  for (std::size_t view = 0; view < 4; ++view) {
    items.push_back(cache.FindOrAdd<int>(KeyOf(view)));
    cache.SetSize(KeyOf(view), 25);
  }
  EXPECT_EQ(cache.size_bytes(), 100U);
  EXPECT_EQ(cache.FindOrAdd<int>(KeyOf(0)), items[0]);  // now 1 is the oldest
  static_cast<void>(cache.FindOrAdd<int>(KeyOf(4)));
  cache.SetSize(KeyOf(4), 25);
  EXPECT_EQ(cache.size_bytes(), 75U);
  EXPECT_EQ(cache.FindOrAdd<int>(KeyOf(0)), items[0]);
  EXPECT_EQ(cache.FindOrAdd<int>(KeyOf(3)), items[3]);
  EXPECT_EQ(cache.FindOrAdd<int>(KeyOf(9)), unknown);
  EXPECT_NE(cache.FindOrAdd<int>(KeyOf(1)), items[1]);
  EXPECT_NE(cache.FindOrAdd<int>(KeyOf(2)), items[2]);
}

TEST(RelitViewCache, RenderingsDoNotDisplaceTemplates) {
  const auto rendering_of = [](std::size_t view) {
    return RelitViewCache::Key{.model = 0, .kind = Kind::kRendering, .view = view, .light = 0};
  };
  RelitViewCache cache(100);
  const auto made = cache.FindOrAdd<int>(KeyOf(0));
  cache.SetSize(KeyOf(0), 10);
  std::vector<std::shared_ptr<int>> renderings;
  for (std::size_t view = 0; view < 20; ++view) {
    renderings.push_back(cache.FindOrAdd<int>(rendering_of(view)));
    cache.SetSize(rendering_of(view), 8);
    EXPECT_LE(cache.size_bytes(), 100U);
    if (view == 10) {
      EXPECT_EQ(cache.size_bytes(), 98U) << "they may fill the budget";
    }
  }
  EXPECT_EQ(cache.FindOrAdd<int>(KeyOf(0)), made) << "the oldest of all";
  EXPECT_EQ(cache.FindOrAdd<int>(rendering_of(19)), renderings[19]);
  EXPECT_NE(cache.FindOrAdd<int>(rendering_of(0)), renderings[0]);
}

TEST(RelitViewCache, TheBudgetWithAFolderGrowsWithTheModels) {
  EXPECT_EQ(RelitViewCache::MaxBytesWithFolder(1), 16'000'000U);
  EXPECT_EQ(RelitViewCache::MaxBytesWithFolder(25), 20'000'000U);
  EXPECT_EQ(RelitViewCache::MaxBytesWithFolder(400), 64'000'000U);
}

TEST(RelitViewCache, AnItemLargerThanTheBudgetIsNotKept) {
  RelitViewCache cache(100);
  const auto item = cache.FindOrAdd<int>(KeyOf(1));
  cache.SetSize(KeyOf(1), 200);
  EXPECT_EQ(cache.size_bytes(), 0U);
  EXPECT_NE(cache.FindOrAdd<int>(KeyOf(1)), item);
  cache.SetSize(KeyOf(5), 10);  // no such item
  EXPECT_EQ(cache.size_bytes(), 0U);
}

}  // namespace
}  // namespace victorious
