// A Vulkan layer for the program under test: its devices never end, or are lost. COWGPU_TEST_DEVICE says how: "hangs" (each
// wait lasts as long as it may), "hangs-at-once" (each wait is over at once, without an end of the work) or "lost". The work
// itself runs on, so that a program that frees what it uses crashes.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

VkInstance the_instance = VK_NULL_HANDLE;
PFN_vkGetInstanceProcAddr next_instance_call = nullptr;
PFN_vkGetDeviceProcAddr next_device_call = nullptr;

template <class Link>
Link* link_of(const void* chain, VkStructureType type) {
  auto* link = static_cast<Link*>(const_cast<void*>(chain));
  while (link && !(link->sType == type && link->function == VK_LAYER_LINK_INFO))
    link = static_cast<Link*>(const_cast<void*>(link->pNext));
  return link;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                                               VkInstance* instance) {
  auto* link = link_of<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  next_instance_call = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_instance_call(nullptr, "vkCreateInstance"));
  const VkResult result = create(info, callbacks, instance);
  if (result == VK_SUCCESS) the_instance = *instance;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* callbacks, VkDevice* device) {
  auto* link = link_of<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  next_device_call = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(next(the_instance, "vkCreateDevice"));
  return create(physical, info, callbacks, device);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice, std::uint32_t, const VkFence*, VkBool32,
                                               std::uint64_t nanoseconds) {
  const char* how = std::getenv("COWGPU_TEST_DEVICE");
  if (how && std::strcmp(how, "lost") == 0) return VK_ERROR_DEVICE_LOST;
  if (how && std::strcmp(how, "hangs") == 0) {
    const timespec slice{time_t(nanoseconds / 1000000000), long(nanoseconds % 1000000000)};
    nanosleep(&slice, nullptr);
  }
  return VK_TIMEOUT;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_call(VkInstance instance, const char* name);

PFN_vkVoidFunction own(const char* name) {
  if (std::strcmp(name, "vkWaitForFences") == 0) return reinterpret_cast<PFN_vkVoidFunction>(wait_for_fences);
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(instance_call);
  if (std::strcmp(name, "vkCreateInstance") == 0) return reinterpret_cast<PFN_vkVoidFunction>(create_instance);
  if (std::strcmp(name, "vkCreateDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(create_device);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_call(VkDevice device, const char* name) {
  if (const PFN_vkVoidFunction call = own(name)) return call;
  return next_device_call(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_call(VkInstance instance, const char* name) {
  if (const PFN_vkVoidFunction call = own(name)) return call;
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(device_call);
  return next_instance_call ? next_instance_call(instance, name) : nullptr;
}

} // namespace

extern "C" __attribute__((visibility("default"))) VkResult
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* loader) {
  loader->loaderLayerInterfaceVersion = 2;
  loader->pfnGetInstanceProcAddr = instance_call;
  loader->pfnGetDeviceProcAddr = device_call;
  loader->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
