!> The flag behind Ctrl-C: set by Python's signal handler, polled by every long loop.
module common_cancel
   use, intrinsic :: iso_c_binding, only : c_int
   use common_c_bindings, only : extrados_cancel_get, extrados_cancel_set
   implicit none
   private
   public :: cancel_requested, cancel_set

contains

   !> 1 requests the running loops to stop, 0 clears the request
   subroutine cancel_set(value)
      integer(c_int), intent(in) :: value
      call extrados_cancel_set(value)
   end subroutine cancel_set

   !> True once the user has requested a stop
   function cancel_requested() result(answer)
      logical :: answer
      answer = extrados_cancel_get() /= 0
   end function cancel_requested

end module common_cancel
