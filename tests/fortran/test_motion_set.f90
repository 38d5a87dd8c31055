!> Motions behind a handle: what goes in comes out, and what is wrong is refused.
program test_motion_set
   use common_handles, only : handle_close, handle_leave
   use common_kinds, only : wp
   use common_motion_set, only : motion_set, motion_set_new, motion_set_take, motion_signal, set_pieces, set_samples
   use common_signal, only : signal
   use common_status, only : status_ok, status_bad_index, status_closed_handle, status_invalid_argument, &
      status_not_finite, status_not_ready
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none (type, external)
   type(motion_set), pointer :: set
   type(signal) :: ground
   integer(c_int64_t) :: handle
   integer(c_int) :: status
   real(wp) :: rows(2, 3), lines(2, 1, 2), sines(4, 1, 1, 2), horizontal, vertical

   call motion_set_new(2_c_int, handle, status)
   call expect(status_ok, 'room for two')
   call motion_set_take(handle, .true., set, status)
   call expect(status_ok, 'take')
   call motion_signal(set, 1_c_int, 1.0_wp, ground, status)
   call expect(status_not_ready, 'a motion not given yet')
   rows = reshape([1.0_wp, 0.5_wp, 2.0_wp, 1.0_wp, 4.0_wp, 2.0_wp], [2, 3])
   call set_samples(set, 1_c_int, 10.0_wp, 0.5_wp, rows, status)
   call expect(status_ok, 'samples')
   call motion_signal(set, 1_c_int, 3.0_wp, ground, status)
   call ground%value_at(2, 10.75_wp, horizontal, vertical)
   if (abs(horizontal - 9.0_wp) > 1e-14_wp .or. abs(vertical - 4.5_wp) > 1e-14_wp) error stop 'samples are not joined'

   lines = reshape([1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp], [2, 1, 2])
   sines = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 3.0_wp, 0.5_wp], [4, 1, 1, 2])
   call set_pieces(set, 2_c_int, [0.0_wp, 1.0_wp, 2.0_wp], lines, sines, status)
   call expect(status_ok, 'pieces')
   call motion_signal(set, 2_c_int, 1.0_wp, ground, status)
   call ground%value_at(1, 0.5_wp, horizontal, vertical)
   if (abs(horizontal - 2.0_wp) > 1e-14_wp) error stop 'a straight line'
   call ground%value_at(2, 1.25_wp, horizontal, vertical)
   if (abs(horizontal - 2.0_wp * sin(1.25_wp)) > 1e-14_wp) error stop 'a sine'

   call set_pieces(set, 2_c_int, [0.0_wp, 1.0_wp, 1.0_wp], lines, sines, status)
   call expect(status_invalid_argument, 'breaks that do not ascend')
   call set_samples(set, 3_c_int, 0.0_wp, 0.5_wp, rows, status)
   call expect(status_bad_index, 'a third of two')
   call set_samples(set, 1_c_int, 0.0_wp, 0.0_wp, rows, status)
   call expect(status_invalid_argument, 'no step')
   call set_samples(set, 1_c_int, 0.0_wp, 0.5_wp, reshape(rows, [3, 2]), status)
   call expect(status_invalid_argument, 'three channels')
   rows(1, 2) = ieee_value(1.0_wp, ieee_quiet_nan)
   call set_samples(set, 1_c_int, 0.0_wp, 0.5_wp, rows, status)
   call expect(status_not_finite, 'no number')
   call handle_leave(handle)
   call handle_close(handle, .false., status)
   call expect(status_ok, 'close')
   call motion_set_take(handle, .false., set, status)
   call expect(status_closed_handle, 'a closed set')
   if (associated(set)) error stop 'a closed set is there'
   print '(a)', 'motion set: all right'

contains

   subroutine expect(wanted, what)
      integer(c_int), intent(in) :: wanted
      character(len=*), intent(in) :: what
      if (status /= wanted) error stop what
   end subroutine expect

end program test_motion_set
