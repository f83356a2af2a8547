// Handle files and frames files.
#include "import/frames_file.h"
#include "import/handle_file.h"

#include <gtest/gtest.h>

#include <limits>

namespace limber::test {
namespace {

TEST(HandleFile, VertexAndPosition_AreRead) {
  const auto handles = bake::ParseHandles(
      R"({"handles":[{"name":"tail","vertex":123},
                     {"name":"knee","position":[1,-2.5,3e2],"free":true,"stiffness":20}]})",
      "h.json");
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  ASSERT_EQ(handles->size(), 2u);
  EXPECT_EQ((*handles)[0].source_vertex, 123u);
  EXPECT_TRUE((*handles)[0].pinned);
  EXPECT_EQ((*handles)[1].position, (Vec3{1, -2.5f, 300}));
  EXPECT_FALSE((*handles)[1].pinned);
  EXPECT_EQ((*handles)[0].stiffness, 1);
  EXPECT_EQ((*handles)[1].stiffness, 20);
}

TEST(HandleFile, Mistakes_NameFileAndElement) {
  const struct {
    const char* text;
    StatusCode code;
    const char* part;
  } cases[] = {
      {"{", StatusCode::kMalformed, "JSON"},
      {"[]", StatusCode::kMalformed, "root"},
      {"{}", StatusCode::kMalformed, "handles"},
      {R"({"handles":[]})", StatusCode::kNoHandles, "empty"},
      {R"({"handles":[{"vertex":1}]})", StatusCode::kMalformed, "handles[0].name"},
      {R"({"handles":[{"name":"a","vertex":1},{"name":"b"}]})", StatusCode::kMalformed,
       "handles[1] \"b\""},
      {R"({"handles":[{"name":"a","vertex":1,"position":[0,0,0]}]})", StatusCode::kMalformed,
       "either"},
      {R"({"handles":[{"name":"a","vertex":-1}]})", StatusCode::kMalformed, "-1"},
      {R"({"handles":[{"name":"a","vertex":1.5}]})", StatusCode::kMalformed, "1.5"},
      {R"({"handles":[{"name":"a","vertex":4294967296}]})", StatusCode::kMalformed, "4294967296"},
      {R"({"handles":[{"name":"a","position":[0,1]}]})", StatusCode::kMalformed, "three numbers"},
      {R"({"handles":[{"name":"a","position":[0,1,1e300]}]})", StatusCode::kMalformed, "1e+300"},
      {R"({"handles":[{"name":"a","position":[0,1,null]}]})", StatusCode::kMalformed, "null"},
      {R"({"handles":[{"name":"a","vertex":1,"pined":true}]})", StatusCode::kMalformed, "pined"},
      {R"({"handles":[{"name":"a","vertex":1,"free":1}]})", StatusCode::kMalformed, "free"},
      {R"({"handles":[{"name":"a","vertex":1,"stiffness":0}]})", StatusCode::kMalformed,
       "stiffness"},
      {R"({"handles":[{"name":"a","vertex":1,"stiffness":"1"}]})", StatusCode::kMalformed, "0.001"},
      {R"({"handles":[{"name":"a","vertex":1}],"x":1})", StatusCode::kMalformed, "\"x\""},
  };

  for (const auto& bad : cases) {
    const Status status = bake::ParseHandles(bad.text, "h.json").status();
    EXPECT_EQ(status.code(), bad.code) << bad.text;
    EXPECT_NE(status.message().find(bad.part), std::string::npos) << status.message();
    EXPECT_EQ(status.message().rfind("h.json: ", 0), 0u) << status.message();
  }
  EXPECT_EQ(bake::ReadHandleFile("/no/such.json").status().code(), StatusCode::kNotFound);
}

TEST(FramesFile, Targets_KeepNamesAndOrder) {
  const auto frames = bake::ParseFrames(
      R"({"frames":[{"targets":{"b":[1,2,3],"a":[0,0,0]}},{},{"targets":{}}]})", "f.json");
  ASSERT_TRUE(frames.ok()) << frames.status().message();
  ASSERT_EQ(frames->size(), 3u);
  ASSERT_EQ((*frames)[0].size(), 2u);
  EXPECT_EQ((*frames)[0][0].handle, "b");
  EXPECT_EQ((*frames)[0][0].target, (Vec3{1, 2, 3}));
  EXPECT_TRUE((*frames)[1].empty());
}

TEST(FramesFile, WhatIsHeldAndHow_ComesBeforeTargets) {
  const auto frames = bake::ParseFrames(
      R"({"frames":[{"rotations":{"a":[0,0,1,0],"b":null},"targets":{"a":[1,2,3]},
                     "stiffness":{"a":2.5,"b":null},"weights":{"a":9,"b":null},"pinned":{"a":true,"b":false}}]})",
      "f.json");
  ASSERT_TRUE(frames.ok()) << frames.status().message();
  const bake::FrameInput& frame = frames->front();
  ASSERT_EQ(frame.size(), 9u);
  EXPECT_EQ(frame[0].pinned, true);
  EXPECT_EQ(frame[1].pinned, false);
  EXPECT_EQ(frame[2].stiffness, 2.5f);
  EXPECT_EQ(frame[3].stiffness, std::numeric_limits<float>::infinity());
  EXPECT_EQ(frame[4].weight, 9.0f);
  EXPECT_EQ(frame[5].weight, std::numeric_limits<float>::infinity());
  EXPECT_EQ(frame[6].target, (Vec3{1, 2, 3}));
  EXPECT_EQ(frame[7].rotation, (Quaternion{0, 0, 1, 0}));
  EXPECT_TRUE(frame[8].clears_rotation);
  EXPECT_FALSE(frame[7].clears_rotation);
}

TEST(FramesFile, Mistakes_NameFrameAndHandle) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"", "JSON"},
      {"{}", "frames"},
      {R"({"frames":{}})", "frames"},
      {R"({"frames":[]})", "frames"},
      {R"({"frames":[{},7]})", "frames[1]"},
      {R"({"frames":[{"target":{}}]})", "\"target\""},
      {R"({"frames":[{"targets":[]}]})", "frames[0].targets"},
      {R"({"frames":[{"targets":{"paw":[1,2]}}]})", "\"paw\""},
      {R"({"frames":[{"targets":{"paw":[1,2,NaN]}}]})", "JSON"},
      {R"({"frames":[{"targets":{"paw":[1,2,1e16]}}]})", "\"paw\""},
      {R"({"frames":[{"targets":{"paw":[1,2,"3"]}}]})", "\"paw\""},
      {R"({"frames":[{"pinned":{"paw":1}}]})", "frames[0].pinned: \"paw\""},
      {R"({"frames":[{"pinned":true}]})", "frames[0].pinned"},
      {R"({"frames":[{"stiffness":{"paw":0}}]})", "frames[0].stiffness: \"paw\""},
      {R"({"frames":[{"stiffness":{"paw":1e300}}]})", "above zero"},
      {R"({"frames":[{"weights":{"paw":-1}}]})", "frames[0].weights: \"paw\""},
      {R"({"frames":[{"weights":{"paw":"9"}}]})", "giving way"},
      {R"({"frames":[{"rotations":{"paw":[0,0,1]}}]})", "frames[0].rotations: \"paw\""},
      {R"({"frames":[{"rotations":{"paw":[0,0,1,"w"]}}]})", "quaternion"},
      {R"({"frames":[{"rotations":{"paw":[0,0,1,1e16]}}]})", "quaternion"},
  };

  for (const auto& bad : cases) {
    const Status status = bake::ParseFrames(bad.text, "f.json").status();
    EXPECT_EQ(status.code(), StatusCode::kMalformed) << bad.text;
    EXPECT_NE(status.message().find(bad.part), std::string::npos) << status.message();
    EXPECT_EQ(status.message().rfind("f.json: ", 0), 0u) << status.message();
  }
}

}  // namespace
}  // namespace limber::test
