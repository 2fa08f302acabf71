// The walk of a vector of poses along the chain, compiled once for each
// instruction set: include after foreach_target.h, between no namespaces.
#if defined(ALIDADE_SRC_MEASUREMENT_CHAIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIDADE_SRC_MEASUREMENT_CHAIN_INL_H_
#undef ALIDADE_SRC_MEASUREMENT_CHAIN_INL_H_
#else
#define ALIDADE_SRC_MEASUREMENT_CHAIN_INL_H_
#endif

#include <Eigen/Core>
#include <cstddef>

#include "src/kernel/aligned.h"
#include "src/kernel/kernel_constants.h"
#include "src/kernel/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
// Each source has its own of each instruction set.
namespace {  // NOLINT(google-build-namespaces)

// ---------------------------------------------------------------- vectors

struct V3 {
  V x, y, z;
};

HWY_INLINE V Broadcast(double value) { return hn::Set(kTag, value); }

HWY_INLINE V3 Broadcast(const Eigen::Vector3d& v) {
  return {Broadcast(v.x()), Broadcast(v.y()), Broadcast(v.z())};
}

HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V3 Scale(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

// s a + b
HWY_INLINE V3 AddScaled(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y),
          hn::MulAdd(s, a.z, b.z)};
}

HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)),
          hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE V3 Load3(const double* from, std::size_t stride) {
  return {hn::Load(kTag, from), hn::Load(kTag, from + stride),
          hn::Load(kTag, from + 2 * stride)};
}

HWY_INLINE void Store3(const V3& v, double* to, std::size_t stride) {
  hn::Store(v.x, kTag, to);
  hn::Store(v.y, kTag, to + stride);
  hn::Store(v.z, kTag, to + 2 * stride);
}

// ------------------------------------------------------------------ chain

// The axes x, y, z and the origin of a frame, in the instrument's frame.
struct Frame {
  V3 x, y, z, origin;
};

// Turns the axes a and b in their plane, from a towards b.
HWY_INLINE void Turn(V cosine, V sine, V3* a, V3* b) {
  const V3 before = *a;
  *a = AddScaled(sine, *b, Scale(cosine, before));
  *b = {hn::NegMulAdd(sine, before.x, hn::Mul(cosine, b->x)),
        hn::NegMulAdd(sine, before.y, hn::Mul(cosine, b->y)),
        hn::NegMulAdd(sine, before.z, hn::Mul(cosine, b->z))};
}

// The frame of a matrix whose columns are the axes.
HWY_INLINE Frame FrameOf(const Eigen::Matrix3d& axes,
                         const Eigen::Vector3d& origin) {
  return {Broadcast(Eigen::Vector3d(axes.col(0))),
          Broadcast(Eigen::Vector3d(axes.col(1))),
          Broadcast(Eigen::Vector3d(axes.col(2))), Broadcast(origin)};
}

// Vectors of a joint in the scratch: the axes of beta, alpha, the joint and of
// its r, the origins before the joint and on its axis; three numbers each.
constexpr std::size_t kArraysPerJoint = 18;

// The lines of one joint, as ChainAxes has them. Of those that no column asks
// for nothing is kept.
struct JointLines {
  double* beta_axis;
  double* alpha_axis;
  double* joint_axis;
  double* origin_before;
  double* origin_on_axis;
  double* slide_axis;  // where tilts turn it, else the joint's
};

HWY_INLINE JointLines LinesOf(double* scratch, int joint, bool is_tilted) {
  const std::size_t lanes = hn::Lanes(kTag);
  double* const first =
      scratch + static_cast<std::size_t>(joint) * kArraysPerJoint * lanes;
  return {first,
          first + 3 * lanes,
          first + 6 * lanes,
          first + 9 * lanes,
          first + 12 * lanes,
          first + (is_tilted ? 15 : 6) * lanes};
}

// Turns by 2 atan(tilt / 2).
HWY_INLINE void Tilt(V tilt, V3* a, V3* b) {
  const V one = Broadcast(1.0);
  const V quarter = hn::Mul(Broadcast(0.25), hn::Mul(tilt, tilt));
  const V scale = hn::Div(one, hn::Add(one, quarter));
  Turn(hn::Mul(hn::Sub(one, quarter), scale), hn::Mul(tilt, scale), a, b);
}

HWY_INLINE void MoveFrame(const double* motion, Frame* frame) {
  const auto load = [motion](int k) {
    return hn::Load(kTag, motion + std::ptrdiff_t{k} * kTile);
  };
  frame->origin = AddScaled(load(0), frame->x, frame->origin);
  frame->origin = AddScaled(load(1), frame->y, frame->origin);
  frame->origin = AddScaled(load(2), frame->z, frame->origin);
  Tilt(load(3), &frame->y, &frame->z);
  Tilt(load(4), &frame->z, &frame->x);
  Tilt(load(5), &frame->x, &frame->y);
}

// Walks one vector of poses from the base to the last frame. `joints` are the
// tile's sines and cosines from the first lane of the vector on, `tilts` and
// `motions` of base and target likewise or null.
HWY_INLINE Frame WalkChain(const Constants& constants, const Columns& columns,
                           const double* joints, const double* tilts,
                           const double* motions, double* scratch) {
  const std::size_t lanes = hn::Lanes(kTag);
  Frame frame = FrameOf(constants.base_rotation, constants.base_translation);
  if (motions != nullptr) MoveFrame(motions, &frame);
  for (int j = 0; j < columns.num_joints(); ++j) {
    const JointConstants& joint = constants.joints[j];
    const Columns::OfJoint& wanted = columns.joint(j);
    const JointLines lines = LinesOf(scratch, j, tilts != nullptr);
    if (wanted.HasTurnBefore()) {
      Store3(frame.origin, lines.origin_before, lanes);
    }
    if (wanted.beta >= 0) Store3(frame.y, lines.beta_axis, lanes);
    if (joint.sin_beta != 0.0 || joint.cos_beta != 1.0) {
      Turn(Broadcast(joint.cos_beta), Broadcast(joint.sin_beta), &frame.z,
           &frame.x);
    }
    if (wanted.HasAlphaAxis()) Store3(frame.x, lines.alpha_axis, lanes);
    if (joint.sin_alpha != 0.0 || joint.cos_alpha != 1.0) {
      Turn(Broadcast(joint.cos_alpha), Broadcast(joint.sin_alpha), &frame.y,
           &frame.z);
    }
    frame.origin = AddScaled(Broadcast(joint.d), frame.x, frame.origin);
    if (wanted.theta >= 0) Store3(frame.origin, lines.origin_on_axis, lanes);
    if (wanted.HasJointAxis()) Store3(frame.z, lines.joint_axis, lanes);
    const V first = hn::Load(kTag, joints + std::ptrdiff_t{2} * j * kTile);
    V cosine = Broadcast(joint.cos_theta);
    V sine = Broadcast(joint.sin_theta);
    V length = Broadcast(joint.r);
    if (joint.is_revolute) {
      // sin and cos of theta + q.
      const V second =
          hn::Load(kTag, joints + (std::ptrdiff_t{2} * j + 1) * kTile);
      const V turned = hn::MulAdd(cosine, first, hn::Mul(sine, second));
      cosine = hn::MulSub(cosine, second, hn::Mul(sine, first));
      sine = turned;
    } else {
      length = hn::Add(length, first);
    }
    Turn(cosine, sine, &frame.x, &frame.y);
    if (tilts != nullptr) {
      const double* const first_tilt = tilts + std::ptrdiff_t{2} * j * kTile;
      Tilt(hn::Load(kTag, first_tilt), &frame.y, &frame.z);
      Tilt(hn::Load(kTag, first_tilt + kTile), &frame.z, &frame.x);
      Store3(frame.z, lines.slide_axis, lanes);
    }
    frame.origin = AddScaled(length, frame.z, frame.origin);
  }
  if (motions != nullptr) {
    MoveFrame(motions + std::ptrdiff_t{6} * kTile, &frame);
  }
  return frame;
}

// Where a target's point is.
HWY_INLINE V3 PointOf(const Frame& frame, const Eigen::Vector3d& point) {
  V3 p = frame.origin;
  if (point.isZero(0.0)) return p;
  p = AddScaled(Broadcast(point.x()), frame.x, p);
  p = AddScaled(Broadcast(point.y()), frame.y, p);
  return AddScaled(Broadcast(point.z()), frame.z, p);
}

// a x + b y + c z of a frame's axes.
HWY_INLINE V3 Combine(const Frame& frame, const Eigen::Vector3d& weights) {
  return AddScaled(Broadcast(weights.z()), frame.z,
                   AddScaled(Broadcast(weights.y()), frame.y,
                             Scale(Broadcast(weights.x()), frame.x)));
}

}  // namespace
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard of each instruction set
