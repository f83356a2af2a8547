/* Limber: real-time character deformation from example shapes. The C interface of the runtime.
 *
 *   context   one per engine or per library copy; several may live side by side, nothing is global
 *   rig       a baked character as it was loaded: shared by its instances and never changed
 *   instance  one character in the scene: its targets, its pose, its skin
 *
 * Rigs and instances are named by ids; an id that is used after its end is answered with
 * LIMBER_ERROR_STALE_ID, never with a crash. Lengths and positions are in the units and the space
 * of the rig's glTF mesh (mesh space), right-handed.
 *
 * Threads: any number of threads may call into a context at once. One instance belongs to one
 * thread at a time; two calls about it must not overlap. Everything else is said at the functions.
 * Those marked [frame] allocate nothing and take no lock while they succeed, once what they use has
 * been made: see limberCreateInstance.
 *
 * Errors: every function that can fail returns a LimberResult and leaves its outputs alone when it
 * does; limberGetLastMessage has one line for people.
 *
 * Structs: a Def can grow, and older and newer callers' are told apart by its size. What functions
 * fill in (Info, State, Report) does not: news come with functions of their own. */
#ifndef LIMBER_LIMBER_H
#define LIMBER_LIMBER_H
/* NOLINTBEGIN(readability-identifier-naming,modernize-*): C's own names and ways */

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define LIMBER_API __declspec(dllexport)
#else
#define LIMBER_API __attribute__((visibility("default")))
#endif

#define LIMBER_VERSION_MAJOR 0
#define LIMBER_VERSION_MINOR 1
#define LIMBER_VERSION_PATCH 0
#define LIMBER_MAKE_VERSION(major, minor, patch) \
  (((uint32_t)(major) << 22) | ((uint32_t)(minor) << 12) | (uint32_t)(patch))
/* Of this header. */
#define LIMBER_VERSION \
  LIMBER_MAKE_VERSION(LIMBER_VERSION_MAJOR, LIMBER_VERSION_MINOR, LIMBER_VERSION_PATCH)

/* Of the library, which may be newer than the header that the caller was compiled with. Any thread.
 */
LIMBER_API uint32_t limberGetVersion(void);

typedef int32_t LimberResult;

enum {
  LIMBER_SUCCESS = 0,
  LIMBER_ERROR_INVALID_ARGUMENT = 1, /* the call makes no sense: null, out of range, not a number */
  LIMBER_ERROR_STALE_ID = 2,         /* the rig or instance is gone, or never was */
  LIMBER_ERROR_STRUCT_NOT_DEFAULT = 3, /* a Def that did not begin with its limberDefault...Def() */
  LIMBER_ERROR_NOT_FOUND = 4,          /* no such file, no such name */
  LIMBER_ERROR_IO = 5,                 /* the operating system refused */
  LIMBER_ERROR_MALFORMED = 6,          /* the file breaks its own format */
  LIMBER_ERROR_UNSUPPORTED = 7,        /* not baked, or baked without what is asked for */
  LIMBER_ERROR_VERSION_MISMATCH = 8,   /* made by something newer than this library */
  LIMBER_ERROR_MESH_MISMATCH = 9,      /* the mesh was changed after it was baked: bake it again */
  LIMBER_ERROR_LIMIT_EXCEEDED = 10,    /* larger than a published limit */
  LIMBER_ERROR_OUT_OF_MEMORY = 11,
  LIMBER_ERROR_DEVICE = 12,     /* the graphics device failed */
  LIMBER_ERROR_INTERNAL = 13,   /* a bug of Limber's own: please report it */
  LIMBER_ERROR_DEVICE_LOST = 14 /* the graphics device is gone: limber_vulkan.h says what to do */
};

/* "stale_id", for logs. Static; any thread; never null. */
LIMBER_API const char* limberResultString(LimberResult result);

typedef struct LimberContext LimberContext;

typedef struct LimberRigId {
  uint32_t index, generation; /* both zero: none */
} LimberRigId;

typedef struct LimberInstanceId {
  uint32_t index, generation;
} LimberInstanceId;

/* ---- Context ------------------------------------------------------------------------------- */

typedef int32_t LimberSeverity;

enum {
  LIMBER_SEVERITY_INFO = 0,
  LIMBER_SEVERITY_WARNING = 1,
  LIMBER_SEVERITY_ERROR = 2 /* what limberGetLastMessage then says */
};

/* Called on the thread that caused it, with no lock held; `message` is one line that lives until
 * the callback returns. It must not throw. */
typedef void (*LimberLogFunction)(void* user, LimberSeverity severity, const char* message);

/* One round of a loop. */
typedef void (*LimberTask)(void* data, uint32_t index);

/* The host's job system: calls task(data, 0) to task(data, count - 1), each once, in any order, on
 * any threads, and returns when all are done. It must not throw. */
typedef void (*LimberRunTasksFunction)(void* user, LimberTask task, void* data, uint32_t count);

/* The host's allocator of memory: that many bytes at a multiple of `alignment`, a power of two;
 * null where there is none, which fails the call with LIMBER_ERROR_OUT_OF_MEMORY and loses nothing.
 * Any thread that calls into the context calls it, several at once, never in a steady frame.
 * Neither function may throw, nor call Limber. */
typedef void* (*LimberAllocateFunction)(void* user, size_t size, size_t alignment);

/* Takes back what the other gave, with the same size and alignment; never null. */
typedef void (*LimberFreeFunction)(void* user, void* memory, size_t size, size_t alignment);

/* Every Def: begin with its limberDefault...Def(), then change what is to differ. */
typedef struct LimberContextDef {
  uint32_t cookie, struct_size; /* set by limberDefaultContextDef; leave them */
  uint32_t header_version;      /* LIMBER_VERSION of the caller's header; set likewise */
  LimberLogFunction log;        /* may be null: nothing is said */
  void* log_user;
  LimberRunTasksFunction run_tasks; /* null: the context has threads of its own, made for the first
                                       limber...Many */
  void* tasks_user;
  int32_t num_threads;             /* of its own, the caller's being one of them; 0: one per core */
  LimberAllocateFunction allocate; /* all that the context, its rigs and instances keep comes from
                                      here; null: from the heap, where also goes what is gone by the
                                      end of a call (a file's text while it is read, an error's
                                      line) and what a thread or a device driver makes for itself */
  LimberFreeFunction free;         /* null only with allocate */
  void* memory_user;
} LimberContextDef;

/* With the caller's header version in it, hence a macro's work as well as a function's. */
LIMBER_API LimberContextDef limberDefaultContextDefOfVersion(uint32_t header_version);
#define limberDefaultContextDef() limberDefaultContextDefOfVersion(LIMBER_VERSION)

/* The caller owns the context and destroys it. Any thread. Errors: INVALID_ARGUMENT (also an
 * allocator of one function, or one whose memory is not aligned), STRUCT_NOT_DEFAULT,
 * VERSION_MISMATCH (a header of another major version), OUT_OF_MEMORY. */
LIMBER_API LimberResult limberCreateContext(const LimberContextDef* def, LimberContext** context);

/* With all its rigs and instances. Null is fine. No other call may run, and the context is gone for
 * all of them. */
LIMBER_API void limberDestroyContext(LimberContext* context);

/* Copies the message of the last failure on this context, zero-terminated and cut to `size` bytes;
 * empty where nothing failed yet. Returns the length that the whole has, as snprintf does. Any
 * thread; takes a lock for the copy. A null context: the reason why the last limberCreateContext of
 * this thread failed. */
LIMBER_API size_t limberGetLastMessage(const LimberContext* context, char* message, size_t size);

/* ---- Rigs ---------------------------------------------------------------------------------- */

typedef struct LimberRigDef {
  uint32_t cookie, struct_size;
  int32_t rig_index; /* which of the file's rigs, 0 the first */
} LimberRigDef;

LIMBER_API LimberRigDef limberDefaultRigDef(void);

/* Reads a baked .glb or .gltf; `path` is UTF-8, `def` may be null. Takes milliseconds to seconds;
 * any thread, while others run frames. Errors: those of the enumeration about files; the message
 * begins with the file. */
LIMBER_API LimberResult limberLoadRig(LimberContext* context, const char* path,
                                      const LimberRigDef* def, LimberRigId* rig);

/* The same of a file in memory (a .gltf with its buffers inside), which may go afterwards. `name`
 * is for messages. */
LIMBER_API LimberResult limberLoadRigFromMemory(LimberContext* context, const void* bytes,
                                                size_t num_bytes, const char* name,
                                                const LimberRigDef* def, LimberRigId* rig);

/* Ends the id. Instances of the rig live on and keep what they need. Any thread. Errors: STALE_ID.
 */
LIMBER_API LimberResult limberDestroyRig(LimberContext* context, LimberRigId rig);

typedef struct LimberRigInfo {
  int32_t num_handles, num_shapes, num_groups;
  int32_t dimension; /* 3; or 2: all lies in one plane, where triangles cover each other in their
                        order and not by depth */
  uint32_t num_vertices; /* of the glTF's primitives, one after the other */
  uint32_t num_triangles;
  float diagonal;            /* of the first example shape's bounding box */
  const uint32_t* triangles; /* [num_triangles][3] vertex numbers in the file's order,
                                counter-clockwise from the front; live until the rig is destroyed */
  const float* texcoords; /* [num_vertices][2], or null, (0, 0) the upper left as in glTF; live as
                             long */
} LimberRigInfo;

/* Any thread. Errors: STALE_ID, INVALID_ARGUMENT. */
LIMBER_API LimberResult limberGetRigInfo(LimberContext* context, LimberRigId rig,
                                         LimberRigInfo* info);

/* A part of the skin with one material: a primitive of the glTF mesh. */
typedef struct LimberPrimitiveInfo {
  uint32_t first_vertex, num_vertices; /* its own: no two primitives share a vertex */
  uint32_t first_triangle, num_triangles;
  int32_t gltf_primitive; /* its number in the file's mesh: those without triangles are left out */
  int32_t gltf_material;  /* the file's number; -1: none, glTF's default */
} LimberPrimitiveInfo;

/* In the file's order, which is that of vertices and triangles. Any thread. Errors: STALE_ID,
 * INVALID_ARGUMENT. */
LIMBER_API LimberResult limberGetNumPrimitives(LimberContext* context, LimberRigId rig,
                                               int32_t* count);
LIMBER_API LimberResult limberGetPrimitiveInfo(LimberContext* context, LimberRigId rig,
                                               int32_t primitive, LimberPrimitiveInfo* info);

typedef struct LimberHandleInfo {
  const char* name;       /* UTF-8; lives until the rig is destroyed */
  float rest_position[3]; /* where it is in the first example shape */
  int32_t pinned;         /* 1: held at its target; 0: it adds freedom, and follows */
} LimberHandleInfo;

LIMBER_API LimberResult limberGetHandleInfo(LimberContext* context, LimberRigId rig, int32_t handle,
                                            LimberHandleInfo* info);

/* The number of a handle, by its name. Errors: STALE_ID, INVALID_ARGUMENT, NOT_FOUND (the message
 * lists what there is). */
LIMBER_API LimberResult limberFindHandle(LimberContext* context, LimberRigId rig, const char* name,
                                         int32_t* handle);

/* ---- Instances ----------------------------------------------------------------------------- */

typedef struct LimberInstanceDef {
  uint32_t cookie, struct_size;
  int32_t max_rotations; /* handles that may have a target rotation at once (4) */
  int32_t guaranteed;    /* 1: room for LimberSolveDef::guaranteed (0) */
  int32_t skin;          /* 1: limberSkin may be called (1) */
  int32_t max_grabs;     /* points of the skin that may be held at once (4) */
  int32_t record;        /* 1: what is asked of it is written down for limberGetRecording (0) */
} LimberInstanceDef;

LIMBER_API LimberInstanceDef limberDefaultInstanceDef(void);

/* At rest. Any thread. Takes milliseconds the first time for a rig, later tens of microseconds. An
 * instance keeps what it has to (for nine handles and six shapes 40 kB) and borrows the rest of its
 * rig while it is solved or skinned. Memory is asked for again by: more solves or skins at once
 * than ever before; the first call for an instance that changes what is held; its first solve with
 * smoothing or with a stretch limit. Ask for these before the frames that must not wait. Errors:
 * STALE_ID, INVALID_ARGUMENT, STRUCT_NOT_DEFAULT, OUT_OF_MEMORY. */
LIMBER_API LimberResult limberCreateInstance(LimberContext* context, LimberRigId rig,
                                             const LimberInstanceDef* def,
                                             LimberInstanceId* instance);

LIMBER_API LimberResult limberDestroyInstance(LimberContext* context, LimberInstanceId instance);

/* Puts another rig under an instance, as when a character was baked again while the game runs. Its
 * handles take over, by name, what was asked of the old ones (held or not, targets, stiffness,
 * weights, rotations); the pose is the solution for that, of the last solve's options, near which
 * the old one was where the rigs are alike. Grabs end. Costs as limberCreateInstance, and a hundred
 * alternations. To reload: load the new file on any thread, then call this for each instance, on
 * the thread that it belongs to, between two frames. Errors, the instance being as it was:
 * STALE_ID, those of limberCreateInstance. */
LIMBER_API LimberResult limberSwitchRig(LimberContext* context, LimberInstanceId instance,
                                        LimberRigId rig);

/* Where a pinned handle is to be. [frame] Errors, the old target staying: STALE_ID,
 * INVALID_ARGUMENT (no such handle, not pinned, not finite or a million times the character's size
 * away). */
LIMBER_API LimberResult limberSetTarget(LimberContext* context, LimberInstanceId instance,
                                        int32_t handle, const float position[3]);

/* A stiffness: how firmly what is held follows its target. LIMBER_HELD_EXACTLY does exactly; a
 * finite one, 1e-6 to 1e9, lets a target out of reach pull the character without tearing it: 1
 * pulls like a square patch of the skin that is stretched along its side, 100 is nearly exact. */
#define LIMBER_HELD_EXACTLY HUGE_VALF

/* How a handle is to be turned from its rest, as a quaternion x, y, z, w of any length but zero;
 * its position is held or not as before. [frame] The first for a handle costs as limberPin does.
 * Errors: as above; LIMIT_EXCEEDED (max_rotations), UNSUPPORTED (an old bake). */
LIMBER_API LimberResult limberSetTargetRotation(LimberContext* context, LimberInstanceId instance,
                                                int32_t handle, const float rotation[4],
                                                float stiffness);
LIMBER_API LimberResult limberClearTargetRotation(LimberContext* context, LimberInstanceId instance,
                                                  int32_t handle);

/* A handle is held where it was baked as pinned; while the game runs any can be pinned, where it is
 * at the moment, and let go. [frame] Calls that change what is held (not: that move it) cost the
 * next solve some tens of microseconds. Errors, nothing being changed: STALE_ID, INVALID_ARGUMENT.
 */
LIMBER_API LimberResult limberPin(LimberContext* context, LimberInstanceId instance,
                                  int32_t handle);
LIMBER_API LimberResult limberUnpin(LimberContext* context, LimberInstanceId instance,
                                    int32_t handle);
LIMBER_API LimberResult limberSetStiffness(LimberContext* context, LimberInstanceId instance,
                                           int32_t handle, float stiffness);

/* How little a handle's target gives way to LimberSolveDef::stretch_limit, beside the others' (1 at
 * first): 1e-6 to 1e9, or HUGE_VALF not at all. [frame] Errors: as above. */
LIMBER_API LimberResult limberSetWeight(LimberContext* context, LimberInstanceId instance,
                                        int32_t handle, float weight);

typedef struct LimberHandleState {
  float target[3];   /* its last one, at first its rest position */
  float position[3]; /* where the skin has it after the last solve */
  int32_t pinned;    /* 1: held */
} LimberHandleState;

/* [frame] Errors: STALE_ID, INVALID_ARGUMENT. */
LIMBER_API LimberResult limberGetHandle(LimberContext* context, LimberInstanceId instance,
                                        int32_t handle, LimberHandleState* state);

/* A place on the skin, wherever the skin goes: a triangle's corners, as LimberRigInfo::triangles
 * numbers them, and barycentric weights of sum one. A vertex is {v, v, v} with {1, 0, 0}. */
typedef struct LimberSkinPoint {
  uint32_t vertices[3];
  float weights[3];
} LimberSkinPoint;

/* Holds any point of the skin, from where it is at the moment. The number in *grab is for the calls
 * below, and is not another grab's until a million later. [frame] Costs as limberPin does. Errors:
 * STALE_ID, INVALID_ARGUMENT, LIMIT_EXCEEDED (max_grabs), UNSUPPORTED (an old bake). */
LIMBER_API LimberResult limberGrab(LimberContext* context, LimberInstanceId instance,
                                   const LimberSkinPoint* point, float stiffness, int32_t* grab);
LIMBER_API LimberResult limberSetGrabTarget(LimberContext* context, LimberInstanceId instance,
                                            int32_t grab, const float position[3]);
LIMBER_API LimberResult limberRelease(LimberContext* context, LimberInstanceId instance,
                                      int32_t grab);

/* Where a point of the skin is after the last solve. [frame] Errors: STALE_ID, INVALID_ARGUMENT. */
LIMBER_API LimberResult limberGetPlace(LimberContext* context, LimberInstanceId instance,
                                       const LimberSkinPoint* point, float position[3]);

typedef struct LimberPickHit {
  int32_t found;                /* 0: the ray meets nothing, and the rest is zero */
  int32_t front_facing;         /* 1: from the side of the normal */
  uint32_t triangle;            /* of LimberRigInfo::triangles */
  LimberSkinPoint point;        /* for limberGrab */
  float position[3], normal[3]; /* mesh space; of the flat triangle, unit */
  float distance;               /* in units of mesh space, whatever the direction's length */
} LimberPickHit;

/* Where a ray first meets the skin of the last solve, from either side: mesh space, `direction` of
 * any length but zero. At equal distances the first triangle counts; of a character in one plane
 * the last, which is painted above the others. Skins the positions and looks at every triangle, a
 * millisecond for 50 thousand: for a click. An engine that has its own way to find a triangle
 * passes it to limberGrab. [frame] after the first of a rig. Errors: STALE_ID, INVALID_ARGUMENT,
 * UNSUPPORTED (an instance without room for skinning). */
LIMBER_API LimberResult limberPick(LimberContext* context, LimberInstanceId instance,
                                   const float origin[3], const float direction[3],
                                   LimberPickHit* hit);

/* Targets at rest, no rotation, held what was baked as held. [frame] */
LIMBER_API LimberResult limberResetToRest(LimberContext* context, LimberInstanceId instance);

typedef struct LimberSolveDef {
  uint32_t cookie, struct_size;
  int32_t iterations; /* alternations of the solve (1: the next frame goes on from there; where
                         targets jump, or frames are few, take 4 to 8 and a settle_tolerance of
                         1e-3, which stops earlier when it can) */
  float nearness;     /* lambda of the paper's eq. 10: how much few examples are preferred (0.5) */
  int32_t rotations;  /* 0: examples are only blended, as in a face (1) */
  int32_t guaranteed; /* 1: the energy never increases while targets stay; some three times the
                         cost (0) */
  double settle_tolerance; /* stop before `iterations` at a change below this (0: never) */
  double stretch_limit;    /* handles stay nearer than this times their longest way over the skin in
                              any example (0: no limit) */
  double smoothing;        /* seconds of lag with which the pose follows smoothly (0: none) */
  double time_step;        /* seconds since the last solve; for smoothing */
  double time_budget;      /* seconds after which no alternation is begun (0: no limit; with one,
                              results depend on the machine) */
} LimberSolveDef;

LIMBER_API LimberSolveDef limberDefaultSolveDef(void);

typedef struct LimberSolveReport {
  double energy;      /* of eq. 10 */
  double change;      /* of the last alternation: the largest of a blend weight or a rotation */
  int32_t iterations; /* done */
  int32_t settled;    /* 1: the tolerance was met */
  int32_t at_rest;    /* 0: smoothing, and still on its way */
} LimberSolveReport;

/* Moves the pose towards its optimum from where the last solve ended. `def` may be null (the
 * defaults), so may `report`. Microseconds, whatever the number of vertices. The same calls give
 * the same bits, on any thread. [frame] Errors, the pose staying: STALE_ID, INVALID_ARGUMENT,
 * STRUCT_NOT_DEFAULT, UNSUPPORTED (rotations of a bake without). */
LIMBER_API LimberResult limberSolve(LimberContext* context, LimberInstanceId instance,
                                    const LimberSolveDef* def, LimberSolveReport* report);

/* How strongly each example takes part in each edge group: [groups][shapes], rows sum to one.
 * `count` must be their product. [frame] */
LIMBER_API LimberResult limberGetBlendWeights(LimberContext* context, LimberInstanceId instance,
                                              double* weights, size_t count);

/* Where the vertices' numbers go: `data` is the first vertex's first float, `stride` bytes lie
 * between two vertices' (a multiple of 4; the host's own vertex layout, interleaved or not). It is
 * only written, from vertex to vertex, never read, and what lies between stays as it is: mapped
 * write-combined memory of any alignment will do. */
typedef struct LimberVertexOutput {
  void* data; /* null: not wanted */
  size_t stride;
} LimberVertexOutput;

typedef struct LimberSkinDef {
  uint32_t cookie, struct_size;
  uint32_t num_vertices;        /* that there is room for: LimberRigInfo::num_vertices */
  LimberVertexOutput positions; /* 3 floats each, mesh space */
  LimberVertexOutput normals;   /* 3 floats each, unit, recomputed from the deformed surface */
  LimberVertexOutput tangents;  /* 4 floats each as in glTF: unit, and the bitangent's sign */
  float* bounds; /* [2][3], smallest and largest of the positions, for culling; null: not wanted */
} LimberSkinDef;

LIMBER_API LimberSkinDef limberDefaultSkinDef(void);

/* Writes the skin of the last solve, or of rest before any, on this processor. Vertices of one
 * point get the same bits, so that no seam opens. [frame] Errors: STALE_ID, INVALID_ARGUMENT (a
 * stride too small or not a multiple of 4, another number of vertices), STRUCT_NOT_DEFAULT,
 * UNSUPPORTED (an instance without room). */
LIMBER_API LimberResult limberSkin(LimberContext* context, LimberInstanceId instance,
                                   const LimberSkinDef* def);

/* ---- Input that moves by itself ------------------------------------------------------------- */

typedef struct LimberFollowDef {
  uint32_t cookie, struct_size;
  double time_step; /* seconds since the last call for this handle (0) */
  double frequency; /* Hz of the spring: how fast the handle follows (3) */
  double damping;   /* 1: as fast as can be without overshoot; below, it swings (1) */
  double reach;     /* no further from any other held handle's target than this times their longest
                       way over the skin in any example; 0: no limit (1) */
} LimberFollowDef;

LIMBER_API LimberFollowDef limberDefaultFollowDef(void);

/* Moves a held handle's target towards a goal that may jump or jitter (a stick, a pointer, a hand),
 * like a weight on a damped spring: the same at any frame rate, for goals that move straight
 * between two calls. It goes on from the handle's target, at rest where that was set by other
 * means. [frame] Errors, the target staying: those of limberSetTarget; INVALID_ARGUMENT (def: out
 * of range), STRUCT_NOT_DEFAULT. */
LIMBER_API LimberResult limberFollow(LimberContext* context, LimberInstanceId instance,
                                     int32_t handle, const float goal[3],
                                     const LimberFollowDef* def);

/* The file's own animations that move a handle's node, or one above it beneath the mesh's. One that
 * cannot be read is left out, with a warning to the log when the rig is loaded. Any thread. */
LIMBER_API LimberResult limberGetNumClips(LimberContext* context, LimberRigId rig, int32_t* count);

typedef struct LimberClipInfo {
  const char* name; /* UTF-8, "clip_2" where the file has none; lives until the rig is destroyed */
  double duration;  /* seconds */
  int32_t num_handles; /* that it moves */
} LimberClipInfo;

LIMBER_API LimberResult limberGetClipInfo(LimberContext* context, LimberRigId rig, int32_t clip,
                                          LimberClipInfo* info);

/* The number of the first clip of that name. Errors: STALE_ID, INVALID_ARGUMENT, NOT_FOUND (the
 * message lists what there is). */
LIMBER_API LimberResult limberFindClip(LimberContext* context, LimberRigId rig, const char* name,
                                       int32_t* clip);

typedef struct LimberClipDef {
  uint32_t cookie, struct_size;
  int32_t clip;
  int32_t loops;     /* 1: time goes round; 0: the clip holds at its ends (1) */
  double time;       /* seconds */
  float weight;      /* from 0, the handles stay where they are asked to be, to 1, they go all the
                        way to the clip: two clips in turn, the second with a weight, are mixed (1) */
  int32_t rotations; /* 1: handles that the clip turns get target rotations as well (1) */
  float rotation_stiffness; /* of those (LIMBER_HELD_EXACTLY) */
} LimberClipDef;

LIMBER_API LimberClipDef limberDefaultClipDef(void);

/* Sets the targets of the handles that a clip moves to where it has them at a time; handles that
 * are not held are left alone. [frame] as limberSetTarget and limberSetTargetRotation. Errors:
 * theirs (handles before the one that is named have moved); INVALID_ARGUMENT (no such clip). */
LIMBER_API LimberResult limberApplyClip(LimberContext* context, LimberInstanceId instance,
                                        const LimberClipDef* def);

/* ---- Recordings ------------------------------------------------------------------------------ */

/* Copies what was asked of an instance since it was made (LimberInstanceDef::record): for tests and
 * bug reports, some 50 bytes a frame. At most `size` bytes are copied; *needed is what the whole
 * has. Frames of a recorded instance may allocate. Errors: STALE_ID, INVALID_ARGUMENT, UNSUPPORTED
 * (nothing is recorded; a recording ends with limberSwitchRig, or for want of memory). */
LIMBER_API LimberResult limberGetRecording(LimberContext* context, LimberInstanceId instance,
                                           void* bytes, size_t size, size_t* needed);

/* Called after each solve of a replay, with an instance that lives as long as the replay: to skin
 * it, to look at it. Other than 0 ends the replay. */
typedef int32_t (*LimberReplayFunction)(void* user, LimberInstanceId instance, uint32_t frame);

typedef struct LimberReplayReport {
  uint32_t num_frames;      /* solves */
  uint32_t num_different;   /* whose pose has not the recorded bits: another kind of machine or
                               another version of Limber, or a bug */
  uint32_t first_different; /* where num_different is not 0 */
} LimberReplayReport;

typedef struct LimberReplayDef {
  uint32_t cookie, struct_size;
  const void* bytes; /* a recording; it may come from anywhere */
  size_t num_bytes;
  LimberReplayFunction on_frame; /* may be null */
  void* user;
} LimberReplayDef;

LIMBER_API LimberReplayDef limberDefaultReplayDef(void);

/* Asks all of a recording once more, of an instance made for it. `report` may be null. Errors:
 * STALE_ID, INVALID_ARGUMENT, STRUCT_NOT_DEFAULT, MALFORMED, VERSION_MISMATCH, MESH_MISMATCH
 * (recorded with another bake), OUT_OF_MEMORY. */
LIMBER_API LimberResult limberReplay(LimberContext* context, LimberRigId rig,
                                     const LimberReplayDef* def, LimberReplayReport* report);

/* ---- Many at once -------------------------------------------------------------------------- */

/* limberSolve of each instance, on the host's job system (LimberContextDef::run_tasks) or on the
 * context's threads; returns when all are done, with the bits that one thread gives. `reports` and
 * `results`, [count], may be null. An instance may be there once only, and in one such call at a
 * time. [frame] but for the first call, which makes the threads. Errors: INVALID_ARGUMENT and
 * LIMIT_EXCEEDED (more than a million) before any is begun; else one of those in `results`, all
 * others being solved nevertheless. */
LIMBER_API LimberResult limberSolveMany(LimberContext* context, const LimberInstanceId* instances,
                                        uint32_t count, const LimberSolveDef* def,
                                        LimberSolveReport* reports, LimberResult* results);

/* limberSkin of each instance into its own def of `defs`, [count]; else as limberSolveMany. */
LIMBER_API LimberResult limberSkinMany(LimberContext* context, const LimberInstanceId* instances,
                                       uint32_t count, const LimberSkinDef* defs,
                                       LimberResult* results);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(readability-identifier-naming,modernize-*) */
#endif /* LIMBER_LIMBER_H */
