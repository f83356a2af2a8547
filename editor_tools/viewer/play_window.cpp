#include "viewer/play_window.h"

#include "core/vector.h"
#include "load/rig_loader.h"
#include "viewer/play_character.h"
#include "viewer/play_controls.h"
#include "viewer/play_presenter.h"
#include "viewer/play_screen.h"
#include "viewer/play_title.h"

#include <chrono>
#include <utility>

namespace limber::viewer {

const char kPlayHelp[] =
    "In the window:\n"
    "  left drag on a dot         moves the handle in the plane of the picture\n"
    "  left drag on the skin      pulls the skin there, until the button is let go\n"
    "  left drag elsewhere        orbits; so does right drag, or Alt and left drag, anywhere\n"
    "  middle drag                pans; so does Shift and right drag\n"
    "  scroll                     zooms\n"
    "  gamepad                    the left stick moves the handle that was dragged last (else the\n"
    "                             first pinned one), the right stick the next pinned one\n"
    "  R                          back to the rest pose\n"
    "  F                          the whole character into the picture\n"
    "  H                          hides and shows the dots\n"
    "  P over a dot               pins the handle where it is, or lets it go\n"
    "  Esc                        closes the window\n"
    "A planar character is seen face on and is panned instead of orbited.\n";

namespace {

using Clock = std::chrono::steady_clock;

// How long to sleep when nothing moves: events end it early, but a gamepad sends none.
constexpr double kIdleSeconds = 1.0 / 30;

// How much of a frame the solver may take.
constexpr double kSolveSeconds = 0.004;

double SecondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// One run of the window: the loop and what it holds, in the order of construction.
class PlaySession {
 public:
  explicit PlaySession(const PlayOptions& options) : options_(options) {}

  Status Open(const std::shared_ptr<const Rig>& rig, MaterialSet materials);
  Status Loop();
  Status Finish();

 private:
  Status HandleInput();
  Status Solve();
  Status Draw();
  bool Done() const;

  const PlayOptions& options_;
  std::unique_ptr<PlayScreen> screen_;
  std::unique_ptr<VulkanDevice> device_;
  std::unique_ptr<PlayPresenter> presenter_;
  std::unique_ptr<PlayCharacter> character_;
  std::unique_ptr<PlayControls> controls_;
  std::unique_ptr<PlayTitle> title_;
  Vector<HandleDot> dots_;
  Clock::time_point last_input_ = Clock::now();
  bool redraw_ = true;
  bool refused_ = false;  // the window did not take the last frame
  int frames_ = 0;
};

Status PlaySession::Open(const std::shared_ptr<const Rig>& rig, MaterialSet materials) {
  PoseOptions pose;
  pose.iterations = options_.iterations;
  pose.lambda = options_.lambda;
  Result<PlayCharacter> character = PlayCharacter::Create(rig, pose);
  if (!character.ok()) return character.status();
  character_ = std::make_unique<PlayCharacter>(std::move(*character));

  title_ = std::make_unique<PlayTitle>(std::string(rig->name()));
  Result<std::unique_ptr<PlayScreen>> screen =
      PlayScreen::Open(title_->text(), options_.width, options_.height);
  if (!screen.ok()) return screen.status();
  screen_ = std::move(*screen);

  DeviceOptions device_options;
  device_options.validation = options_.validation;
  screen_->PrepareDevice(&device_options);
  Result<std::unique_ptr<VulkanDevice>> device = VulkanDevice::Create(device_options);
  if (!device.ok()) return device.status();
  device_ = std::move(*device);

  CharacterSource source;
  source.mesh = &rig->mesh();
  source.space = rig->tables().space;
  source.dimension = rig->dimension();
  source.materials = std::move(materials);
  Result<std::unique_ptr<PlayPresenter>> presenter = PlayPresenter::Create(
      device_.get(), source, screen_->picture_size(), options_.wait_for_display);
  if (!presenter.ok()) return presenter.status();
  presenter_ = std::move(*presenter);

  const VkExtent2D size = presenter_->extent();
  controls_ = std::make_unique<PlayControls>(character_.get(), static_cast<float>(size.width),
                                             static_cast<float>(size.height));
  screen_->SendTo(controls_.get());
  dots_.resize(static_cast<size_t>(rig->num_handles()));
  return {};
}

bool PlaySession::Done() const {
  return screen_->should_close() || (options_.max_frames > 0 && frames_ >= options_.max_frames);
}

Status PlaySession::Loop() {
  while (!Done()) {
    LIMBER_RETURN_IF_ERROR(HandleInput());
    LIMBER_RETURN_IF_ERROR(Solve());
    LIMBER_RETURN_IF_ERROR(controls_->UpdateHover());
    redraw_ |= controls_->TakeChange() || screen_->TakeRefresh() || options_.max_frames > 0;
    if (redraw_) LIMBER_RETURN_IF_ERROR(Draw());
    if (title_->Update()) screen_->SetTitle(title_->text());
  }
  return {};
}

Status PlaySession::HandleInput() {
  const VkExtent2D window = screen_->picture_size();
  const bool hidden = window.width == 0 || window.height == 0;
  const bool idle = hidden || refused_ || (!redraw_ && !character_->moving());
  LIMBER_RETURN_IF_ERROR(screen_->Poll(idle ? kIdleSeconds : 0));
  const Result<bool> resized = presenter_->Fit(screen_->picture_size());
  if (!resized.ok()) return resized.status();
  if (*resized) {
    const VkExtent2D size = presenter_->extent();
    controls_->Resized(static_cast<float>(size.width), static_cast<float>(size.height));
  }
  const Clock::time_point now = Clock::now();
  controls_->SticksHeld(screen_->sticks(), SecondsBetween(last_input_, now));
  last_input_ = now;
  return {};
}

Status PlaySession::Solve() {
  // As many steps as fit, so that the pose does not trail behind the pointer where drawing is slow;
  // one, always, when a number of frames was asked for: such runs do not depend on the clock.
  const Clock::time_point start = Clock::now();
  Clock::time_point step = start, now = start;
  while (character_->moving()) {
    LIMBER_RETURN_IF_ERROR(character_->Step());
    redraw_ = true;
    now = Clock::now();
    title_->AddSolve(1e3 * SecondsBetween(step, now));
    step = now;
    if (options_.max_frames > 0 || SecondsBetween(start, now) > kSolveSeconds) break;
  }
  return {};
}

Status PlaySession::Draw() {
  const std::span<const Vec3> positions = character_->handle_positions();
  for (size_t h = 0; h < dots_.size(); ++h) {
    const auto handle = static_cast<int>(h);
    dots_[h] = {positions[h], character_->pinned(handle), controls_->hovered_handle() == handle,
                controls_->grabbed_handle() == handle};
  }
  Scene scene;
  scene.transforms = character_->transforms();
  scene.camera = &controls_->camera();
  if (controls_->dots_shown()) scene.dots = dots_;
  const Result<bool> shown = presenter_->Show(scene);
  if (!shown.ok()) return shown.status();
  refused_ = !*shown;
  if (refused_) return {};  // still to be drawn
  redraw_ = false;
  ++frames_;
  title_->AddFrame(presenter_->times());
  return {};
}

Status PlaySession::Finish() {
  if (!options_.screenshot_path.empty()) {
    LIMBER_RETURN_IF_ERROR(presenter_->Screenshot(options_.screenshot_path));
  }
  controls_.reset();
  presenter_.reset();
  const ValidationLog& log = device_->validation_log();
  if (log.count() == 0) return {};
  return Error(StatusCode::kInternal, "play: the validation layer gave %d messages, the first: %s",
               log.count(), log.messages().front().c_str());
}

}  // namespace

Status PlayRig(const std::shared_ptr<const Rig>& rig, MaterialSet materials,
               const PlayOptions& options) {
  PlaySession session(options);
  LIMBER_RETURN_IF_ERROR(session.Open(rig, std::move(materials)));
  LIMBER_RETURN_IF_ERROR(session.Loop());
  return session.Finish();
}

Status RunPlay(const PlayOptions& options) {
  Result<std::shared_ptr<const Rig>> rig = LoadRig(options.path);
  if (!rig.ok()) return rig.status();
  Result<MaterialSet> materials = ReadMaterials(options.path);
  if (!materials.ok()) return materials.status();
  return PlayRig(*rig, std::move(*materials), options);
}

}  // namespace limber::viewer
