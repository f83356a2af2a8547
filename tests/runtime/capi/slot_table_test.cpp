// Ids that are never mistaken for another's, found while others come and go.
#include "capi/slot_table.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace limber::capi {
namespace {

SlotId Insert(SlotTable<int>* table, int number) {
  SlotId id;
  EXPECT_TRUE(table->Insert(std::make_unique<int>(number), &id));
  return id;
}

TEST(SlotTable, FindsWhatIsThere_AndNothingElse) {
  SlotTable<int> table;
  EXPECT_EQ(table.Find({0, 0}), nullptr);
  EXPECT_EQ(table.Find({0, 1}), nullptr);
  Vector<SlotId> ids;
  for (int i = 0; i < 3000; ++i)
    ids.push_back(Insert(&table, i));
  for (int i = 0; i < 3000; ++i) {
    ASSERT_NE(table.Find(ids[size_t(i)]), nullptr);
    EXPECT_EQ(*table.Find(ids[size_t(i)]), i);
    EXPECT_NE(ids[size_t(i)].generation, 0u);
  }
  EXPECT_EQ(table.Find({ids[5].index, ids[5].generation + 1}), nullptr);
  EXPECT_EQ(table.Find({4000000000u, 1}), nullptr);
}

TEST(SlotTable, RemovedIds_StayGoneWhoeverComesNext) {
  SlotTable<int> table;
  const SlotId first = Insert(&table, 1);
  const auto removed = table.Remove(first);
  ASSERT_NE(removed, nullptr);
  EXPECT_EQ(*removed, 1);
  EXPECT_EQ(table.Remove(first), nullptr);
  const SlotId second = Insert(&table, 2);
  EXPECT_EQ(second.index, first.index) << "slots are used again";
  EXPECT_EQ(table.Find(first), nullptr);
  EXPECT_EQ(*table.Find(second), 2);
}

TEST(SlotTable, ReadersGoOn_WhileOthersComeAndGo) {
  SlotTable<int> table;
  const SlotId kept = Insert(&table, 42);
  std::atomic<bool> done = false;
  std::thread reader([&] {
    while (!done) {
      const int* found = table.Find(kept);
      ASSERT_NE(found, nullptr);
      ASSERT_EQ(*found, 42);
    }
  });
  for (int round = 0; round < 20; ++round) {
    Vector<SlotId> ids;
    for (int i = 0; i < 500; ++i)
      ids.push_back(Insert(&table, i));
    for (const SlotId id : ids)
      EXPECT_NE(table.Remove(id), nullptr);
  }
  done = true;
  reader.join();
}

}  // namespace
}  // namespace limber::capi
