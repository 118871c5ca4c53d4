#include "app/completion.hpp"

#include "app/schema/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fascia::app {

namespace {

/// Deeper keys are rarely overridden, and schemas that refer to themselves have no end.
constexpr int kDeepest = 5;

struct Path {
  std::string text;    ///< "bodies.*.material.young", "loads.#.force": a name, a number
  std::string values;  ///< words that the key takes
};

/// The keys that --set may name below `shape`. @param inside  the reference that led here, which is not followed twice
void add_paths(const Shape& shape, const std::string& path, int depth, std::vector<Path>& all,
               const std::string& inside = "") {
  if (depth > kDeepest) return;
  switch (shape.type) {
    case Type::table:
      for (const Key& key : shape.keys)
        if (key.refusal.empty())
          add_paths(key.shape, path.empty() ? key.name : path + "." + key.name, depth + 1, all, inside);
      return;
    case Type::named_tables:
      add_paths(shape.items.front(), path + ".*", depth + 1, all, inside);
      return;
    case Type::array:
      if (shape.items.front().type == Type::table && depth == 1)
        add_paths(shape.items.front(), path + ".#", depth + 1, all, inside);
      else
        all.push_back({path, ""});
      return;
    case Type::one_of:
      for (const Shape& alternative : shape.items) add_paths(alternative, path, depth, all, inside);
      return;
    case Type::reference:
      if (shape.name == inside)
        all.push_back({path, ""});
      else
        add_paths(shape.target(), path, depth, all, shape.name);
      return;
    case Type::choice:
      all.push_back({path, fmt::format("{}", fmt::join(supported_values(shape), " "))});
      return;
    case Type::boolean:
      all.push_back({path, "true false"});
      return;
    default:
      all.push_back({path, ""});
  }
}

/// A line a key: alternatives of a key side by side, their values together.
std::string key_table() {
  std::vector<Path> all;
  add_paths(scene_schema(), "", 0, all);
  std::stable_sort(all.begin(), all.end(), [](const Path& a, const Path& b) { return a.text < b.text; });
  std::string table;
  for (std::size_t i = 0; i < all.size();) {
    std::string line = all[i].text;
    for (const std::string& path = all[i].text; i < all.size() && all[i].text == path; ++i)
      if (!all[i].values.empty()) line += " " + all[i].values;
    table += line + "\n";
  }
  return table;
}

constexpr const char* kFunctions = R"bash(
# The keys of the scene format, one a line with the values that it takes; * stands for a name, # for a number.
_fascia_keys() {
  cat <<'KEYS'
)bash";

constexpr const char* kRest = R"bash(KEYS
}

# Lists what the scene file $1 has in the place of the * or # at the end of $2: names or numbers of its tables.
_fascia_names() {
  local section=${2%%.*} count
  [ -f "$1" ] || return
  case $2 in
    *.\*) sed -nE "s/^[[:space:]]*\[+${section}\.([A-Za-z0-9_-]+)[].].*/\1/p" "$1" | sort -u ;;
    *) count=$(grep -cE "^[[:space:]]*\[\[${section}\]\]" "$1"); [ "$count" -gt 0 ] && seq 0 $((count - 1)) ;;
  esac
}

# The keys, with the names and numbers of the scene $1 in them.
_fascia_scene_keys() {
  local key stem='' before name names
  while read -r key _; do
    case $key in
      *[*#]*)
        before=$stem stem=${key%%[*#]*}
        [ "$stem" = "$before" ] || mapfile -t names < <(_fascia_names "$1" "${key:0:$((${#stem} + 1))}")
        for name in "${names[@]}"; do echo "$stem$name${key:$((${#stem} + 1))}"; done ;;
      *) echo "$key" ;;
    esac
  done < <(_fascia_keys) | sed 's/$/=/' | sort -u
}

# Offers those lines of the input that begin with $1, as they are: nothing of a scene is expanded.
_fascia_offer() {
  local word
  COMPREPLY=()
  while IFS= read -r word; do
    if [[ $word == "$1"* ]]; then COMPREPLY+=("$word"); fi
  done
}

# The values that the key $1 takes, with names and numbers as a scene has them.
_fascia_values() {
  local key values pattern dots=${1//[^.]/}
  while read -r key values; do
    pattern=${key//\#/*}
    # shellcheck disable=SC2053 # a pattern; a name has no dots
    if [[ $1 == $pattern && ${key//[^.]/} == "$dots" ]]; then tr ' ' '\n' <<<"$values"; fi
  done < <(_fascia_keys)
}

_fascia() {
  local line=${COMP_LINE:0:COMP_POINT} current previous scene='' word words command=''
  current=${line##* }
  read -ra words <<<"${line%"$current"}"
  previous=${words[-1]}
  for word in "${words[@]:1}"; do
    case $word in
      *.toml) scene=$word ;;
      -*) ;;
      *) [ -n "$command" ] || command=$word ;;
    esac
  done
  case $previous in
    --set)
      if [[ $current == *=* ]]; then
        _fascia_offer "${current#*=}" < <(_fascia_values "${current%%=*}")
      else
        _fascia_offer "$current" < <(_fascia_scene_keys "$scene")
        compopt -o nospace 2>/dev/null
      fi
      return ;;
    --backend) mapfile -t COMPREPLY < <(compgen -W 'auto cpu cuda' -- "$current"); return ;;
    --output) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
  esac
  case $command in
)bash";

}  // namespace

std::string bash_completion(const std::vector<CommandWords>& commands) {
  std::string names, cases;
  for (const CommandWords& c : commands) {
    names += (names.empty() ? "" : " ") + c.name;
    cases +=
        fmt::format("    {}) words=('{} {}') ;;\n", c.name, fmt::join(c.options, " "), fmt::join(c.arguments, " "));
  }
  return "# bash completion for fascia; made by: fascia completion bash" + std::string(kFunctions) + key_table() +
         kRest + cases + fmt::format("    *) words=('{} --help --version') ;;\n", names) +
         R"bash(  esac
  mapfile -t COMPREPLY < <(compgen -W "${words[0]}" -- "$current")
  if [[ $command != @(bench|list|verify) && $current != -* ]]; then
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -d -S / -- "$current"; compgen -f -X '!*.toml' -- "$current")
    compopt -o filenames 2>/dev/null
  fi
}
complete -F _fascia fascia
)bash";
}

}  // namespace fascia::app
