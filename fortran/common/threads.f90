!> Threads that a parallel loop may ask for: OpenMP ends the process where the system has no room for one.
module common_threads
   use, intrinsic :: iso_c_binding, only : c_int
   use common_c_bindings, only : extrados_threads
   implicit none
   private
   public :: threads_available

contains

   !> As many of the wanted threads as can be started now, at least 1; what is computed does not depend on it
   function threads_available(wanted) result(count)
      integer(c_int), intent(in) :: wanted
      integer(c_int) :: count
      count = extrados_threads(wanted)
   end function threads_available

end module common_threads
