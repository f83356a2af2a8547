// The same in C++, by the thin face over the C interface.
#include <limber/limber.hpp>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  try {
    limber::api::Context context;
    const limber::api::Rig rig = context.LoadRig(argv[1]);
    const LimberRigInfo info = rig.Info();
    limber::api::Instance character = rig.MakeInstance();
    const LimberHandleState rest = character.Handle(0);
    const float step = 0.1f * info.diagonal;
    character.SetTarget(0, {rest.target[0] + step, rest.target[1], rest.target[2]});
    for (int frame = 0; frame < 20; ++frame)
      character.Solve();
    const float moved = character.Handle(0).position[0] - rest.target[0];
    std::printf("moved %.3f of the diagonal\n", static_cast<double>(moved / info.diagonal));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
