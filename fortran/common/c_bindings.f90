!> Interfaces of the C part, one for each function of c/include/extrados.h.
module common_c_bindings
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t, c_char, c_funptr, c_ptr
   implicit none
   private
   public :: extrados_list_entry, extrados_library_init
   public :: extrados_cancel_set, extrados_cancel_get, extrados_cancel_unheard, extrados_watch_signals
   public :: extrados_handle_new, extrados_handle_take, extrados_handle_leave, extrados_handle_close
   public :: extrados_handle_count, extrados_threads

   interface
      subroutine extrados_cancel_set(value) bind(c)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: value
      end subroutine extrados_cancel_set

      function extrados_cancel_get() bind(c) result(value)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: value
      end function extrados_cancel_get

      function extrados_cancel_unheard() bind(c) result(value)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: value
      end function extrados_cancel_unheard

      subroutine extrados_watch_signals(on) bind(c)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: on
      end subroutine extrados_watch_signals

      function extrados_list_entry(index, code, name_size, name, text_size, text) bind(c) result(found)
         import :: c_int, c_char
         implicit none (type, external)
         integer(c_int), value, intent(in) :: index, name_size, text_size
         integer(c_int), intent(out) :: code
         character(kind=c_char), intent(out) :: name(*), text(*)
         integer(c_int) :: found
      end function extrados_list_entry

      function extrados_handle_new(kind, object, destroy, handle) bind(c) result(status)
         import :: c_int, c_int64_t, c_funptr, c_ptr
         implicit none (type, external)
         integer(c_int), value, intent(in) :: kind
         type(c_ptr), value, intent(in) :: object
         type(c_funptr), value, intent(in) :: destroy
         integer(c_int64_t), intent(out) :: handle
         integer(c_int) :: status
      end function extrados_handle_new

      function extrados_handle_take(handle, kind, alone, object) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: kind, alone
         type(c_ptr), intent(out) :: object
         integer(c_int) :: status
      end function extrados_handle_take

      subroutine extrados_handle_leave(handle) bind(c)
         import :: c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: handle
      end subroutine extrados_handle_leave

      function extrados_handle_close(handle, later) bind(c) result(status)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: later
         integer(c_int) :: status
      end function extrados_handle_close

      function extrados_handle_count() bind(c) result(count)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: count
      end function extrados_handle_count

      function extrados_threads(wanted) bind(c) result(count)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: wanted
         integer(c_int) :: count
      end function extrados_threads

      function extrados_library_init() bind(c) result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: status
      end function extrados_library_init
   end interface

end module common_c_bindings
