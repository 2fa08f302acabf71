#ifndef ALIDADE_VERSION_H_
#define ALIDADE_VERSION_H_

namespace alidade {

/// The version of the library, "major.minor.patch", as in CMakeLists.txt.
const char* Version();

}  // namespace alidade

#endif  // ALIDADE_VERSION_H_
