// SPDX-License-Identifier: MIT
#include "rayshade/schedule/work_book.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "rayshade/schedule/granularity.h"

namespace rayshade {
namespace {

const char* const kSchedules[] = {"roundrobin", "bands", "blocks", "cost"};

WorkBookOptions options(const std::string& schedule, int workers) {
  WorkBookOptions out;
  out.schedule = schedule;
  out.workers = workers;
  out.block_side = 8;
  return out;
}

std::vector<std::int64_t> numbers(const std::vector<Block>& blocks) {
  std::vector<std::int64_t> out;
  for (const Block& block : blocks) out.push_back(block.number);
  return out;
}

/// Workers with queues of their own, on a clock that goes by hundredths of a second. Each does a block in so
/// many ticks as it is slow; it may hang, be lost, come late, come back, and say everything twice.
class Crowd {
 public:
  Crowd(WorkBook& book, unsigned seed)
      : book_(book), random_(seed), given_(book.count()), counted_(book.count()) {}

  void add(int worker, int slowness, int threads) { workers_[worker] = {slowness, threads, {}, false, 0}; }
  std::size_t size() const { return workers_.size(); }

  /// Whether the picture is complete after at most so many ticks.
  bool run(int ticks, bool trouble) {
    for (int tick = 0; tick < ticks && !book_.complete(); ++tick, now_ += .01) {
      for (auto& [number, worker] : workers_) step(number, worker, trouble);
      if (trouble && chance(30))
        add(100 + static_cast<int>(random_() % 50), 1 + static_cast<int>(random_() % 9), 1);
    }
    return book_.complete();
  }

  void check_every_block_counted_once() const {
    for (const int times : counted_) ASSERT_EQ(times, 1);
    for (const int times : given_) ASSERT_GE(times, 1);
  }

 private:
  struct Worker {
    int slowness = 1, threads = 1;
    std::deque<Block> queue;
    bool hangs = false;
    int progress = 0;
  };
  bool chance(unsigned in) { return random_() % in == 0; }

  void report(int number, const Block& block, int slowness) {
    counted_[static_cast<std::size_t>(block.number)] +=
        book_.finished(block.number, number, .01 * slowness, now_);
  }

  void step(int number, Worker& worker, bool trouble) {
    if (trouble && number != 0 && chance(200)) worker.hangs = !worker.hangs;
    if (trouble && number != 0 && chance(150)) {
      book_.lost(number);
      // What it had done may come all the same.
      for (const Block& block : worker.queue)
        if (chance(3)) report(number, block, worker.slowness);
      worker.queue.clear();
      return;
    }
    if (worker.hangs) return;
    if (asks_for_more(worker.queue.size(), static_cast<std::size_t>(worker.threads))) {
      const std::vector<Block> blocks = book_.take(number, worker.threads, now_);
      for (const Block& block : blocks) {
        ++given_[static_cast<std::size_t>(block.number)];
        ASSERT_EQ(block, book_.block(block.number));
        worker.queue.push_back(block);
      }
    }
    if (worker.queue.empty() || ++worker.progress % worker.slowness != 0) return;
    const Block block = worker.queue.front();
    worker.queue.pop_front();
    report(number, block, worker.slowness);
    if (trouble && chance(10)) report(number, block, worker.slowness);
  }

  WorkBook& book_;
  std::mt19937 random_;
  std::vector<int> given_, counted_;
  std::map<int, Worker> workers_;
  double now_ = 0;
};

TEST(WorkBookTest, EveryBlockCountsOnceWhateverHappens) {
  for (const std::string schedule : kSchedules) {
    for (unsigned seed = 0; seed < 150; ++seed) {
      SCOPED_TRACE(schedule + ", seed " + std::to_string(seed));
      std::mt19937 random(seed);
      const int width = 1 + static_cast<int>(random() % 200), height = 1 + static_cast<int>(random() % 200);
      const int workers = 1 + static_cast<int>(random() % 40);
      WorkBookOptions it = options(schedule, workers);
      it.granularity = static_cast<int>(random() % 12);
      it.most_copies = 1 + static_cast<int>(random() % 3);
      it.lease_seconds = .5;
      it.starts = seed % 3 == 0 ? "third" : seed % 3 == 1 ? "half" : "two-circles";
      WorkBook book(width, height, it);
      Crowd crowd(book, seed);
      for (int i = 0; i < workers; ++i)
        if (i == 0 || random() % 4 != 0)  // some never come
          crowd.add(i, 1 + static_cast<int>(random() % 9), 1 + static_cast<int>(random() % 3));
      ASSERT_TRUE(crowd.run(1'000'000, seed % 5 != 0));
      crowd.check_every_block_counted_once();
      EXPECT_EQ(book.missing(), 0);
      EXPECT_EQ(book.unassigned(), 0);
      EXPECT_TRUE(book.take(0, 1, 1e9).empty());
    }
  }
}

TEST(WorkBookTest, OneSurvivorEndsTheJob) {
  for (const std::string schedule : kSchedules) {
    for (const bool told : {true, false}) {
      SCOPED_TRACE(schedule + (told ? ", told" : ", not told"));
      WorkBookOptions it = options(schedule, 20);
      it.most_copies = 1;  // all must come back by the leases' ends
      WorkBook book(160, 160, it);
      for (int worker = 1; worker < 20; ++worker) {
        EXPECT_FALSE(book.take(worker, 1, 0).empty());
        if (told) book.lost(worker);
      }
      Crowd crowd(book, 1);
      crowd.add(0, 1, 1);
      EXPECT_TRUE(crowd.run(told ? 1000 : 20'000, false));
      EXPECT_EQ(book.leased(), 0);
    }
  }
}

TEST(WorkBookTest, BlocksOfALostWorkerComeFirst) {
  WorkBook book(160, 160, options("blocks", 4));
  const auto first = numbers(book.take(0, 1, 0));
  book.take(1, 1, 0);
  book.lost(0);
  auto again = numbers(book.take(2, 1, 1));
  const auto more = numbers(book.take(3, 1, 1));
  again.insert(again.end(), more.begin(), more.end());
  for (const std::int64_t number : first)
    EXPECT_LT(std::find(again.begin(), again.end(), number) - again.begin(),
              static_cast<std::int64_t>(first.size()));
}

TEST(WorkBookTest, ASecondResultIsIgnoredAndCounted) {
  WorkBook book(16, 8, options("blocks", 1));
  const auto mine = book.take(0, 2, 0);
  ASSERT_EQ(mine.size(), 2U);
  EXPECT_TRUE(book.finished(0, 0, 1, 1));
  EXPECT_FALSE(book.finished(0, 0, 1, 1));
  EXPECT_FALSE(book.finished(0, 5, 1, 1));
  EXPECT_EQ(book.repeated(), 2);
  EXPECT_EQ(book.missing(), 1);
  EXPECT_TRUE(book.finished(1, 7, 1, 1));  // of one who was never given it
  EXPECT_TRUE(book.complete());
  EXPECT_EQ(book.leased(), 0);
}

TEST(WorkBookTest, OverdueBlocksGoToIdleWorkersOldestFirst) {
  WorkBookOptions it = options("blocks", 3);
  it.granularity = 1;
  WorkBook book(32, 8, it);
  const auto a = numbers(book.take(0, 1, 0));
  ASSERT_TRUE(book.finished(a[0], 0, 1, 1));
  const auto b = numbers(book.take(0, 1, 1));
  const auto c = numbers(book.take(1, 1, 1.1));
  const auto d = numbers(book.take(2, 1, 1.2));
  ASSERT_EQ(d.size(), 1U);
  ASSERT_TRUE(book.finished(d[0], 2, 1, 2.2));
  EXPECT_TRUE(book.take(2, 1, 2.3).empty());  // a second is expected, a half more is patience
  EXPECT_EQ(numbers(book.take(2, 1, 3)), b);
  EXPECT_TRUE(book.take(0, 1, 2.9).empty() || book.copies() > 1);  // never its own
  EXPECT_EQ(book.copies() >= 1, true);
  EXPECT_TRUE(book.finished(b[0], 2, 1, 4));
  EXPECT_FALSE(book.finished(b[0], 0, 1, 5));
  EXPECT_TRUE(book.finished(c[0], 1, 1, 5));
  EXPECT_TRUE(book.complete());
}

// Eight workers on one processor: a second of work takes eight by the clock.
TEST(WorkBookTest, WhereAllAreLateNoneIsOverdue) {
  WorkBookOptions it = options("blocks", 2);
  it.granularity = 1;
  WorkBook book(40, 8, it);
  double now = 0;
  for (int i = 0; i < 3; ++i) {
    const auto done = numbers(book.take(0, 1, now));
    ASSERT_EQ(done.size(), 1U);
    now += 8;
    ASSERT_TRUE(book.finished(done[0], 0, 1, now));
  }
  const auto a = numbers(book.take(0, 1, now)), b = numbers(book.take(1, 1, now));
  ASSERT_EQ(b.size(), 1U);
  ASSERT_TRUE(book.finished(b[0], 1, 1, now + 7));
  EXPECT_TRUE(book.take(1, 1, now + 11).empty());  // eight seconds, and half as many more
  EXPECT_EQ(book.copies(), 0);
  EXPECT_EQ(numbers(book.take(1, 1, now + 13)), a);
}

TEST(WorkBookTest, LeasesEndAndLateResultsAreWelcome) {
  WorkBookOptions it = options("blocks", 2);
  it.most_copies = 1;
  it.granularity = 2;
  WorkBook book(16, 8, it);
  const auto hung = numbers(book.take(0, 2, 0));
  ASSERT_EQ(hung.size(), 2U);
  EXPECT_TRUE(book.take(1, 2, 9).empty());
  EXPECT_EQ(numbers(book.take(1, 2, 1000)).size(), 2U);
  EXPECT_EQ(book.expired(), 2);
  EXPECT_TRUE(book.finished(hung[0], 0, 999, 1000));
  EXPECT_EQ(book.leased(), 1);
}

TEST(WorkBookTest, BlocksThatAreThereAreNotGiven) {
  for (const std::string schedule : kSchedules) {
    WorkBook book(80, 80, options(schedule, 3));
    std::set<std::int64_t> skipped;
    for (std::int64_t number = 0; number < book.count(); number += 3) {
      book.skip(number);
      book.skip(number);
      skipped.insert(number);
    }
    EXPECT_EQ(book.missing(), book.count() - static_cast<std::int64_t>(skipped.size()));
    for (double now = 0; !book.complete(); now += 1) {
      for (const Block& block : book.take(0, 1, now)) {
        EXPECT_FALSE(skipped.contains(block.number));
        EXPECT_TRUE(book.finished(block.number, 0, .1, now));
      }
    }
  }
}

TEST(WorkBookTest, MessagesShrinkTowardTheEnd) {
  WorkBook book(512, 512, options("blocks", 4));
  std::vector<std::size_t> sizes;
  for (double now = 0; !book.complete(); now += .01) {
    const auto blocks = book.take(static_cast<int>(sizes.size() % 4), 1, now);
    sizes.push_back(blocks.size());
    for (const Block& block : blocks) book.finished(block.number, 0, 1e-4, now);
  }
  EXPECT_GE(*std::max_element(sizes.begin(), sizes.end()), 32U);
  EXPECT_EQ(sizes.back(), 1U);
  EXPECT_TRUE(std::is_sorted(sizes.begin() + 8, sizes.end(), std::greater<>()));
}

TEST(WorkBookTest, FastWorkersGetMore) {
  WorkBook book(1024, 1024, options("cost", 2));
  std::size_t given[2] = {};
  // Worker 1 takes ten times as long for everything. Both are asked in turn.
  for (double now = 0; now < 40; now += 1) {
    for (const int worker : {0, 1}) {
      const auto blocks = book.take(worker, 1, now);
      if (now > 10) given[worker] += blocks.size();
      for (const Block& block : blocks) book.finished(block.number, worker, worker == 0 ? .01 : .1, now);
    }
  }
  // Not ten times as many: what is learned from both is a mixture until each has done much.
  EXPECT_GT(given[0], 2 * given[1]);
}

TEST(WorkBookTest, UnknownSchedulesAreRefused) {
  EXPECT_THROW(WorkBook(8, 8, options("spiral", 1)), std::invalid_argument);
  EXPECT_EQ(WorkBook(8, 8, options("", 1)).schedule_name(), resolve_schedule("auto"));
}

/// A million blocks for a hundred thousand workers: nothing may take time in proportion to either per
/// request.
TEST(WorkBookTest, SchedulesAMillionBlocksInSeconds) {
  for (const std::string schedule : kSchedules) {
    const bool lines = schedule == "roundrobin" || schedule == "bands";
    WorkBook book(lines ? 8 : 8000, lines ? 1'000'000 : 8000, options(schedule, 100'000));
    const auto start = std::chrono::steady_clock::now();
    std::mt19937 random(1);
    for (double now = 0; !book.complete(); now += 1) {
      for (int worker = 0; worker < 100'000 && !book.complete(); ++worker)
        for (const Block& block : book.take(worker, 1, now))
          book.finished(block.number, worker, 1e-3 * static_cast<double>(random() % 100), now);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
#ifndef RAYSHADE_SANITIZED
    EXPECT_LT(took.count(), 20) << schedule;
#endif
    RecordProperty(schedule + "_milliseconds", static_cast<int>(1000 * took.count()));
  }
}

TEST(GranularityTest, AWorkerAsksWhenNoBlockWaits) {
  EXPECT_FALSE(asks_for_more(2, 1));
  EXPECT_TRUE(asks_for_more(1, 1));
  EXPECT_TRUE(asks_for_more(0, 1));
  EXPECT_FALSE(asks_for_more(5, 4));
  EXPECT_TRUE(asks_for_more(4, 4));
}

TEST(GranularityTest, LimitsHold) {
  EXPECT_EQ(message_size({1'000'000, 100, 1, 1, 1, 1, 0}).blocks, 150);
  EXPECT_EQ(message_size({1'000'000, 100, 1, 1, 1, 1, 7}).blocks, 7);
  EXPECT_EQ(message_size({1'000'000, 0, 1, 1, 1, 1, 0}).blocks, 4);  // nothing is known
  EXPECT_EQ(message_size({3, 100, 1, 8, 1, 1, 2}).blocks, 8);        // every thread has one
  EXPECT_EQ(message_size({1, 1, .001, 1, 1, 1, 0}).blocks, 1);
  EXPECT_DOUBLE_EQ(message_size({100, 40, .1, 2, .5, 1, 0}).seconds, 1);
}

}  // namespace
}  // namespace rayshade
