!> A rocking structure with what stands against it or holds it: a wall on one side, ties, springs and dampers.
module rocking_restrained
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use rocking_restraint, only : restraint_set, restraint_set_new, restraint_state
   use rocking_rocker, only : rocker
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: restrain_body

   integer, parameter :: scan = 400

contains

   !> Add to a structure what restrains it
   subroutine restrain_body(body, list, status)
      class(rocker), intent(inout) :: body
      !> open to +x and to -x (1 or 0), rate after over before being thrown back to each side, number of restraints,
      !> their list (restraint_set_new)
      real(wp), intent(in) :: list(:)
      integer(c_int), intent(out) :: status
      integer :: count, side, stat

      status = status_invalid_argument
      if (size(list) < 5) return
      if (any(list(3:4) < 0.0_wp) .or. any(list(3:4) > 1.0_wp) .or. list(5) < 0.0_wp) return
      body%free = list(1:2) > 0.5_wp
      if (.not. any(body%free)) return
      body%rebound = list(3:4)
      count = nint(list(5))
      status = status_ok
      if (count < 1) return
      allocate (body%held, stat=stat)
      status = status_out_of_memory
      if (stat /= 0) return
      call restraint_set_new(list(6:), count, body%held, status)
      if (status /= status_ok) return
      do side = 1, -1, -2
         call find_critical(body, body%held, side, status)
         if (status /= status_ok) return
      end do
   end subroutine restrain_body

   !> The rotation at which weight and restraints, pulled from rest for the first time, no longer push back; the limit
   !> of collapse where they do up to there
   subroutine find_critical(body, held, side, status)
      class(rocker), intent(inout) :: body
      type(restraint_set), intent(in) :: held
      integer, intent(in) :: side
      integer(c_int), intent(out) :: status
      type(restraint_state), allocatable :: fresh(:)
      real(wp) :: low, high, q, previous
      integer :: i, k, stat

      i = merge(1, 2, side > 0)
      allocate (fresh(held%count), stat=stat)
      status = status_out_of_memory
      if (stat /= 0) return
      status = status_ok
      call held%reset_states(i, 0.0_wp, fresh)
      previous = 0.0_wp
      do k = 1, scan
         q = body%limit(i) * real(k, wp) / real(scan, wp)
         if (resists(q)) then
            previous = q
            cycle
         end if
         low = previous
         high = q
         do stat = 1, 60
            q = 0.5_wp * (low + high)
            if (resists(q)) then
               low = q
            else
               high = q
            end if
         end do
         body%critical(i) = low
         ! pushed away from rest at once: whether the structure is stable then follows from the motion alone
         if (low <= 0.0_wp) body%critical(i) = body%limit(i) / real(scan, wp)
         return
      end do
      body%critical(i) = body%limit(i)

   contains

      !> Do weight and restraints push back at a rotation?
      function resists(rotation) result(answer)
         real(wp), intent(in) :: rotation
         logical :: answer
         real(wp) :: m, half_dm, dv, dh
         logical :: closed
         call body%coefficients(side, rotation, m, half_dm, dv, dh, closed)
         answer = dv + held%first_moment(i, rotation, fresh) > 0.0_wp
      end function resists

   end subroutine find_critical

end module rocking_restrained
