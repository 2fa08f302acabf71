#ifndef ALIDADE_VERSION_H_
#define ALIDADE_VERSION_H_

namespace alidade {

/// The version of the library, "major.minor.patch", as in CMakeLists.txt.
const char* Version();

/// How this library was built: commit where it was known, build type, compiler
/// and its flags, sanitizers; one line each.
const char* BuildDescription();

}  // namespace alidade

#endif  // ALIDADE_VERSION_H_
