#ifndef ALIDADE_SRC_SERIALIZATION_YAML_MERGE_H_
#define ALIDADE_SRC_SERIALIZATION_YAML_MERGE_H_

#include <string>

#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

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

#endif  // ALIDADE_SRC_SERIALIZATION_YAML_MERGE_H_
