#ifndef ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_

#include <string>

#include "src/serialization/yaml_reader.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

/// A job file and those that it inherits from, which are read here: `extends:
/// BASE.yaml` lays the file on BASE, map by map, lists and single values
/// replaced (Overlay, below). Every value keeps its file, line and column, and
/// paths stay relative to the file that states them. The key `extends` is gone
/// from the result; `matrix` is left to who reads it.
///
/// A file that states other `units` than its base is refused: they would change
/// what the base's numbers mean.
/// @throws InputError, also where files extend each other in a circle or are
/// more than 32.
YamlDocument ReadJobTree(const YamlValue& root);

/// Lays `over` on `*under`, which becomes both: maps are merged key by key, to
/// any depth; anything else is replaced. A key of `over` that says null (`~`)
/// takes the key away. Values keep the place that they were read at. `document`
/// holds both trees' files; `path` is the dotted path of `*under`, for
/// messages.
/// @throws InputError where null takes nothing away.
void Overlay(const YamlDocument& document, const std::string& path,
             const YamlNode& over, YamlNode* under);

/// Sets the value at a dotted path of a tree, in place of what is there. Maps
/// on the way that are missing are made, at the places of `value` and its key.
void SetAt(const std::string& path, const YamlNode& value, YamlNode* root);

/// Takes a map's key away, where it is there.
void RemoveKey(const std::string& key, YamlNode* map);

/// The document and what it inherits: `base` below `*document`, with the files
/// of both. @throws InputError as Overlay.
void Inherit(YamlDocument base, YamlDocument* document);

/// A text that two trees share if and only if they say the same.
std::string CanonicalText(const YamlNode& node);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_
