#include "host/parallel.hpp"
#include "host/thread_pool.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace cowgpu;

namespace {

// How often each of so many tasks was run.
std::vector<int> runs_of_each(ThreadPool& pool, std::size_t tasks) {
  std::vector<std::atomic<int>> count(tasks);
  pool.run(tasks, [&](std::size_t task, unsigned thread) {
    if (thread < pool.threads()) ++count[task];
  });
  return {count.begin(), count.end()};
}

} // namespace

TEST_CASE("a thread pool runs every task once, call after call", "[thread_pool]") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    CHECK(pool.threads() == threads);
    for (int call = 0; call < 300; ++call)
      for (const std::size_t tasks : {0U, 1U, 2U, 7U, 64U})
        REQUIRE(runs_of_each(pool, tasks) == std::vector<int>(tasks, 1));
  }
}

TEST_CASE("a thread pool asked for 0 threads takes all", "[thread_pool]") {
  const ThreadPool pool;
  CHECK(pool.threads() == all_threads());
}

TEST_CASE("a thread pool runs in order on the caller's thread where it has one thread", "[thread_pool]") {
  ThreadPool pool(1);
  std::vector<std::size_t> order;
  const auto caller = std::this_thread::get_id();
  pool.run(5, [&](std::size_t task, unsigned thread) {
    order.push_back(task);
    CHECK(thread == 0);
    CHECK(std::this_thread::get_id() == caller);
  });
  CHECK(order == std::vector<std::size_t>{0, 1, 2, 3, 4});
}

TEST_CASE("thread 0 of a thread pool is the caller, and the others share the work", "[thread_pool]") {
  ThreadPool pool(3);
  const auto caller = std::this_thread::get_id();
  std::atomic<int> met{0}, wrong{0};
  // Every task waits until all threads are there, so that each of them has to take one.
  pool.run(3, [&](std::size_t, unsigned thread) {
    ++met;
    while (met < 3) std::this_thread::yield();
    if ((thread == 0) != (std::this_thread::get_id() == caller)) ++wrong;
  });
  CHECK(met == 3);
  CHECK(wrong == 0);
}

TEST_CASE("workers that fell asleep take part in the next call", "[thread_pool]") {
  ThreadPool pool(2);
  for (int call = 0; call < 5; ++call) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::atomic<int> met{0};
    pool.run(2, [&](std::size_t, unsigned) {
      ++met;
      while (met < 2) std::this_thread::yield();
    });
    CHECK(met == 2);
  }
}

TEST_CASE("an exception in a task ends a thread pool's call, and the next call is whole", "[thread_pool]") {
  for (const unsigned threads : {1U, 4U}) {
    ThreadPool pool(threads);
    for (int call = 0; call < 100; ++call) {
      std::atomic<int> done{0};
      CHECK_THROWS_WITH(pool.run(1000,
                                 [&](std::size_t task, unsigned) {
                                   if (task == 3) throw std::runtime_error("task 3");
                                   ++done;
                                 }),
                        "task 3");
      CHECK(done < 1000);
      REQUIRE(runs_of_each(pool, 9) == std::vector<int>(9, 1));
    }
  }
}

TEST_CASE("of several exceptions in a thread pool one arrives", "[thread_pool]") {
  ThreadPool pool(4);
  for (int call = 0; call < 100; ++call)
    CHECK_THROWS_AS(pool.run(8, [](std::size_t, unsigned) { throw std::logic_error("all"); }), std::logic_error);
}
