#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/method/method.h"

namespace raystudy {

/// Every method that is linked in or was loaded from RAYSTUDY_PLUGINS, by role and name.
class Registry {
 public:
  using Factory = std::function<std::unique_ptr<Method>(const Params&)>;

  struct Entry {
    Role role = Role::builder;
    MethodInfo info;
    Factory make;
    std::string origin;  ///< "built in", or the plugin's file
  };

  [[nodiscard]] static Registry& instance();

  /// A second method of the same role and name is not added but kept as a conflict: registration runs before main, where
  /// nobody could catch an exception. `require_no_conflicts` reports it.
  void add(Role role, MethodInfo info, Factory make);
  /// Throws Error naming both origins where two methods of one role have one name.
  void require_no_conflicts() const;

  [[nodiscard]] const Entry* find(Role role, std::string_view name) const;
  /// Throws Error with the nearest valid name.
  [[nodiscard]] const Entry& get(Role role, std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names(Role role) const;  ///< sorted
  [[nodiscard]] std::vector<const Entry*> entries() const;        ///< sorted by role and name

  /// `T` is a role's class, e.g. create<Builder>(ref).
  template <class T>
  [[nodiscard]] std::unique_ptr<T> create(const MethodRef& ref) const {
    std::unique_ptr<Method> made = get(T::role, ref.name).make(ref.params ? *ref.params : default_params(T::role, ref.name));
    return std::unique_ptr<T>(static_cast<T*>(made.release()));
  }
  [[nodiscard]] Params default_params(Role role, std::string_view name) const;
  /// Default parameters with some replaced; checks names, types and ranges as YAML does. Throws Error.
  [[nodiscard]] MethodRef ref(Role role, std::string_view name,
                              std::map<std::string, ParamValue, std::less<>> changes = {}) const;

  /// The file that methods registered from now on come from; set around dlopen.
  void set_origin(std::string origin) { origin_ = std::move(origin); }

 private:
  std::map<std::pair<Role, std::string>, Entry> entries_;
  std::vector<std::string> conflicts_;
  std::string origin_ = "built in";
};

/// One static object of this at the end of a plugin's file registers `T`, which has `static MethodInfo info()` and a constructor
/// from `const Params&`.
template <class T>
struct Registration {
  Registration() {
    Registry::instance().add(T::role, T::info(),
                             [](const Params& p) -> std::unique_ptr<Method> { return std::make_unique<T>(p); });
  }
};

/// What a parameter takes, in words: "an integer in [2, 256]", "one of low, high".
[[nodiscard]] std::string expected_text(const ParamSpec& spec);

/// Checks `value` against `spec`: type (an integer passes for a real), range, choice. Returns the value in its declared type.
/// Throws Error whose message names the parameter, what was found and what is expected.
[[nodiscard]] ParamValue checked(const ParamSpec& spec, const ParamValue& value);

/// Loads every shared library named in the colon-separated list (RAYSTUDY_PLUGINS): files, or folders whose *.so are all loaded.
/// Throws Error naming the file where one cannot be loaded, registers nothing, or brings a name that exists.
void load_plugins(std::string_view paths);

}  // namespace raystudy
