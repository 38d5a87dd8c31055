!> Lists of names and numbers, handles, cancel flag.
module api_support
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: list_entry, close_handle, handle_count, set_cancel, cancel_requested, cancel_unheard
   public :: watch_signals, init_libraries

contains

   !> Entry of the lists of c/include/extrados_lists.h, one behind the other; found = 0 past the end
   subroutine list_entry(position, found, code, name, text)
      use common_c_bindings, only : extrados_list_entry
      integer(c_int), intent(in) :: position    !! 0-based
      integer(c_int), intent(out) :: found
      integer(c_int), intent(out) :: code
      character(len=64), intent(out) :: name    !! LIST.NAME
      character(len=128), intent(out) :: text
      code = 0
      name = ' '
      text = ' '
      found = extrados_list_entry(position, code, 64_c_int, name, 128_c_int, text)
   end subroutine list_entry

   !> Destroy the object behind a handle; while a call uses it: status busy, or with later = 1 when that call ends
   subroutine close_handle(handle, later, status)
      use common_handles, only : handle_close
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: later
      integer(c_int), intent(out) :: status
      call handle_close(handle, later /= 0, status)
   end subroutine close_handle

   !> Number of objects that live in the core
   subroutine handle_count(number)
      use common_c_bindings, only : extrados_handle_count
      integer(c_int), intent(out) :: number
      number = extrados_handle_count()
   end subroutine handle_count

   !> Ask the running loops to stop (1), or clear the flag (0)
   subroutine set_cancel(value)
      use common_cancel, only : cancel_set
      integer(c_int), intent(in) :: value
      call cancel_set(value)
   end subroutine set_cancel

   !> Whether the running loops were asked to stop (1)
   subroutine cancel_requested(value)
      use common_cancel, only : cancel => cancel_requested
      integer(c_int), intent(out) :: value
      value = merge(1, 0, cancel())
   end subroutine cancel_requested

   !> Whether they were asked to stop and none has looked at it since (1)
   subroutine cancel_unheard(value)
      use common_c_bindings, only : extrados_cancel_unheard
      integer(c_int), intent(out) :: value
      value = extrados_cancel_unheard()
   end subroutine cancel_unheard

   !> From now on (1) Ctrl-C and SIGTERM also set the flag, for calls from threads that may not touch Python's handlers;
   !> until it was said as often that they need not (0)
   subroutine watch_signals(on)
      use common_c_bindings, only : extrados_watch_signals
      integer(c_int), intent(in) :: on
      call extrados_watch_signals(on)
   end subroutine watch_signals

   !> Once per process: GSL's aborting error handler is turned off, BLAS takes its first buffer
   subroutine init_libraries(status)
      use common_c_bindings, only : extrados_library_init
      integer(c_int), intent(out) :: status
      status = extrados_library_init()
   end subroutine init_libraries

end module api_support
