#ifndef ALIDADE_SRC_INITIALIZATION_INITIAL_FRAMES_H_
#define ALIDADE_SRC_INITIALIZATION_INITIAL_FRAMES_H_

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/identifiability.h"
#include "alidade/references.h"

namespace alidade::internal {

/// An arm with its base and targets, and what it is measured against.
struct InitialFrames {
  Arm arm;
  References references;
};

/// Finds base, targets and unknown references from the data and the nominal
/// geometry of the joints alone, without a guess of the user's: closed-form and
/// linear fits of frames (frame_start.h), good enough to start an iteration
/// from. Base and targets are looked for where `candidates` has them. What the
/// data do not determine stays as it is. O(N) time.
InitialFrames FindInitialFrames(const Arm& arm, const References& references,
                                Dataset data, CandidateGroups candidates);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_INITIALIZATION_INITIAL_FRAMES_H_
