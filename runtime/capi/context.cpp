#include "capi/context.h"

#include <algorithm>
#include <cstring>

namespace limber::capi {
namespace {

constexpr uint32_t kContextCookie = 0x4C4D4301;
constexpr size_t kStrictestAlignment = 64;  // of all that is asked of a host's allocator

// Why the last limberCreateContext of this thread failed; static storage.
thread_local const char* create_message = "";

LimberResult CreateFailed(LimberResult result, const char* message) {
  create_message = message;
  return result;
}

uint32_t MajorOf(uint32_t version) {
  return version >> 22;
}

// The host's functions, kept in memory of their own, as long as the context.
LimberResult KeepMemorySource(const LimberContextDef& def, const MemorySource** kept) {
  const MemorySource host = {def.allocate, def.free, def.memory_user};
  if ((host.allocate == nullptr) != (host.free == nullptr)) {
    return CreateFailed(LIMBER_ERROR_INVALID_ARGUMENT,
                        "limberCreateContext: allocate, free: one of them is null");
  }
  if (host.allocate == nullptr) return LIMBER_SUCCESS;
  void* memory = host.allocate(host.user, sizeof(host), kStrictestAlignment);
  if (memory == nullptr) {
    return CreateFailed(LIMBER_ERROR_OUT_OF_MEMORY,
                        "limberCreateContext: allocate: gave null for the first few bytes");
  }
  if (reinterpret_cast<uintptr_t>(memory) % kStrictestAlignment != 0) {
    host.free(host.user, memory, sizeof(host), kStrictestAlignment);
    return CreateFailed(LIMBER_ERROR_INVALID_ARGUMENT,
                        "limberCreateContext: allocate: gave memory that is not aligned as asked");
  }
  *kept = new (memory) MemorySource(host);
  return LIMBER_SUCCESS;
}

void ForgetMemorySource(const MemorySource* kept) {
  if (kept == nullptr) return;
  const MemorySource host = *kept;
  host.free(host.user, const_cast<MemorySource*>(kept), sizeof(host), kStrictestAlignment);
}

// Null where there is no memory for it.
LimberContext* MakeContext(const LimberContextDef& def, const MemorySource* memory) {
  const MemoryScope scope(memory);
  try {
    auto* made = new LimberContext();
    made->def = def;
    made->memory = memory;
    return made;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

size_t CopyText(const char* text, size_t length, char* to, size_t size) {
  if (to == nullptr || size == 0) return length;
  const size_t count = std::min(length, size - 1);
  std::memcpy(to, text, count);
  to[count] = '\0';
  return length;
}

}  // namespace

LimberResult End(LimberContext* context, const char* function, const CallStatus& status) {
  std::string message;
  try {
    message = std::string(function) + ": " +
              (status.message.empty() ? limberResultString(status.result) : status.message);
    const std::lock_guard lock(context->message_mutex);
    context->message.assign(message);
  } catch (const std::bad_alloc&) {  // then the code has to do
  }
  if (context->def.log != nullptr)
    context->def.log(context->def.log_user, LIMBER_SEVERITY_ERROR, message.c_str());
  return status.result;
}

CallStatus NullArgument(const char* name) {
  return {LIMBER_ERROR_INVALID_ARGUMENT, std::string(name) + ": is null"};
}

CallStatus CheckHandle(const Rig& rig, int32_t handle) {
  if (handle >= 0 && handle < rig.num_handles()) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT,
          "handle " + std::to_string(handle) + ": there are " + std::to_string(rig.num_handles())};
}

CallStatus StaleId(const char* what, uint32_t index, uint32_t generation) {
  return {LIMBER_ERROR_STALE_ID, std::string(what) + " " + std::to_string(index) + "." +
                                     std::to_string(generation) + ": is gone, or never was"};
}

}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

uint32_t limberGetVersion(void) {
  return LIMBER_VERSION;
}

LimberContextDef limberDefaultContextDefOfVersion(uint32_t header_version) {
  LimberContextDef def = {};
  def.cookie = kContextCookie;
  def.struct_size = sizeof(def);
  def.header_version = header_version;
  return def;
}

LimberResult limberCreateContext(const LimberContextDef* def, LimberContext** context) {
  if (context == nullptr)
    return CreateFailed(LIMBER_ERROR_INVALID_ARGUMENT, "limberCreateContext: context: is null");
  LimberContextDef full = limberDefaultContextDef();
  const CallStatus status = Catch([&] { return ReadDef(def, "LimberContextDef", &full); });
  if (!status.ok()) {
    return CreateFailed(status.result,
                        "limberCreateContext: def: not what limberDefaultContextDef() gives");
  }
  if (MajorOf(full.header_version) != LIMBER_VERSION_MAJOR) {
    return CreateFailed(
        LIMBER_ERROR_VERSION_MISMATCH,
        "limberCreateContext: limber.h is of another major version than the library");
  }
  const MemorySource* memory = nullptr;
  const LimberResult kept = KeepMemorySource(full, &memory);
  if (kept != LIMBER_SUCCESS) return kept;
  LimberContext* made = MakeContext(full, memory);
  if (made == nullptr) {
    ForgetMemorySource(memory);
    return CreateFailed(LIMBER_ERROR_OUT_OF_MEMORY, "limberCreateContext: out of memory");
  }
  *context = made;
  return LIMBER_SUCCESS;
}

void limberDestroyContext(LimberContext* context) {
  if (context == nullptr) return;
  const MemorySource* memory = context->memory;
  {
    const MemoryScope scope(memory);  // destructors may make things, too
    delete context;
  }
  ForgetMemorySource(memory);
}

size_t limberGetLastMessage(const LimberContext* context, char* message, size_t size) {
  if (context == nullptr) {
    const char* text = create_message;
    return CopyText(text, std::strlen(text), message, size);
  }
  const std::lock_guard lock(context->message_mutex);
  return CopyText(context->message.c_str(), context->message.size(), message, size);
}

}  // extern "C"
