// SPDX-License-Identifier: Apache-2.0
// Scenes of sweep points and their references, kept while neighbouring points use them: a few of each, whatever the sweep's size.
#pragma once
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "image.hpp"
#include "reference.hpp"
#include "sweep_point.hpp"

namespace spantex::sim {

// The latest `most` values by name; each made once, also when several threads ask at a time.
template <class T>
class recent {
 public:
  explicit recent(size_t most) : most_(most) {}

  std::shared_ptr<const T> get(const std::string& name, const std::function<T()>& make) {
    std::promise<std::shared_ptr<const T>> promise;
    std::shared_future<std::shared_ptr<const T>> value;
    bool mine = false;
    {
      const std::lock_guard guard(lock_);
      for (auto i = kept_.begin(); i != kept_.end(); ++i)
        if (i->first == name) {
          kept_.splice(kept_.begin(), kept_, i);
          value = i->second;
          break;
        }
      if (!value.valid()) {
        value = promise.get_future().share();
        mine = true;
        kept_.emplace_front(name, value);
        if (kept_.size() > most_) kept_.pop_back();
      }
    }
    if (mine) {
      try {
        promise.set_value(std::make_shared<const T>(make()));
      } catch (...) {
        promise.set_exception(std::current_exception());
      }
    }
    return value.get();
  }

 private:
  size_t most_;
  std::mutex lock_;
  std::list<std::pair<std::string, std::shared_future<std::shared_ptr<const T>>>> kept_;
};

// What a picture is compared with: made from level 0 as it was before it was encoded.
struct sweep_reference {
  ideal_image ideal;
  image rounded;
  std::vector<int> items;  // that each pixel shows, -1 for background
  size_t shown = 0;        // pixels that are not background
};

inline constexpr rgba8 sweep_background{0, 0, 0, 255};

const std::vector<std::string>& sweep_scene_names();
bool is_sweep_map(const std::string& name);  // one that is made here; others are files
bool moves(const std::string& scene, camera_motion how);

class sweep_subjects {
 public:
  std::shared_ptr<const scene> scene_of(const sweep_subject& s, int frame);
  std::shared_ptr<const sweep_reference> reference_of(const sweep_subject& s, int frame);
  // The picture of a point's twin, by name.
  std::shared_ptr<const image> twin_of(const std::string& name, const std::function<image()>& make) { return twins_.get(name, make); }

 private:
  recent<std::shared_ptr<const map_list>> maps_{8};
  recent<scene> scenes_{24};
  recent<sweep_reference> references_{24};
  recent<image> twins_{48};
};

std::string name_of(const sweep_subject& s, int frame);  // all that its picture depends on

}  // namespace spantex::sim
