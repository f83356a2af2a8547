// From a file to a skinned frame on a machine that runs out of memory: each allocation fails once.
#include "load/file_bytes.h"
#include "load/rig_loader.h"
#include "load/uri.h"
#include "skin/cpu_skinner.h"
#include "skin/skin_topology.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <new>
#include <string>
#include <vector>

namespace {

// Allocations of at least `smallest` bytes until one fails; none does while it is zero.
struct Fault {
  std::size_t smallest = 0;
  int countdown = 0;
};

Fault fault;

void* AllocateOrFail(std::size_t size) {
  if (fault.countdown > 0 && size >= fault.smallest && --fault.countdown == 0) {
    throw std::bad_alloc();
  }
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return AllocateOrFail(size);
}

void* operator new[](std::size_t size) {
  return AllocateOrFail(size);
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete[](void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace limber {
namespace {

const std::filesystem::path kFile = LIMBER_SOURCE_DIR "/content/baked/v1/square.glb";

// Runs prepare() and then, with the nth allocation failing, the work that it returned; for n = 1,
// 2, ... until the work needs fewer. Each run ends in a Status, none in an exception. Returns how
// many allocations there were to fail.
int FailEach(std::size_t smallest, const std::function<std::function<Status()>()>& prepare) {
  for (int n = 1;; ++n) {
    const std::function<Status()> work = prepare();
    fault = {smallest, n};
    Status status;
    bool threw = false;
    try {
      status = work();
    } catch (...) {
      threw = true;
    }
    const bool failed = fault.countdown == 0;
    fault = {};
    EXPECT_FALSE(threw) << "allocation " << n;
    if (!failed) {
      EXPECT_TRUE(status.ok()) << status.message();
      return n - 1;
    }
    if (!threw) {
      EXPECT_EQ(status.code(), StatusCode::kOutOfMemory) << n << ": " << status.message();
    }
  }
}

// The parser's destructors use a little heap of their own and end the program without it, so that
// here only allocations of some size fail: those whose size a file names.
constexpr std::size_t kNamedByTheFile = 4096;

TEST(OutOfMemory, Loading_IsAStatus) {
  EXPECT_GT(FailEach(kNamedByTheFile, [] { return [] { return LoadRig(kFile).status(); }; }), 20);
}

TEST(OutOfMemory, ReadingAFile_IsAStatus) {
  EXPECT_GT(FailEach(1, [] { return [] { return ReadFileBytes(kFile, 1u << 30).status(); }; }), 0);
}

TEST(OutOfMemory, DecodingAUri_IsAStatus) {
  const std::string uri = "data:application/octet-stream;base64," + std::string(4000, 'A');
  EXPECT_GT(FailEach(1, [&uri] { return [&uri] { return DecodeDataUri(uri, 1 << 20).status(); }; }),
            0);
}

TEST(OutOfMemory, CreatingARig_IsAStatus) {
  const auto rig = LoadRig(kFile);
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  const int count = FailEach(1, [&rig] {
    const auto name = std::make_shared<std::string>(100, 'n');
    const auto tables = std::make_shared<RigTables>((*rig)->tables());
    const auto mesh = std::make_shared<SkinMesh>((*rig)->mesh());
    return [name, tables, mesh] {
      return Rig::Create(std::move(*name), std::move(*tables), std::move(*mesh)).status();
    };
  });
  EXPECT_GT(count, 3);
}

TEST(OutOfMemory, CreatingASkinner_IsAStatus) {
  const auto rig = LoadRig(kFile);
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  const int count = FailEach(1, [&rig] {
    return [&rig] { return CpuSkinner::Create((*rig)->mesh(), (*rig)->tables().space).status(); };
  });
  EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace limber
