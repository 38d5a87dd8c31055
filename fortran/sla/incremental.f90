!> The nonlinear incremental peer: all overloaded points lose a tooth at once.
module sla_incremental
   use common_kinds, only : wp
   use common_status, only : status_ok
   use sla_group, only : along, bound, event_vectors, point_group, scan_result
   use sla_model, only : element_model, model_factor, model_solve
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: damage_overloaded

contains

   !> One iteration of an incremental analysis: in each element the most overloaded point at a multiplier loses a tooth,
   !> all at once; then the factor and the displacements are made anew
   subroutine damage_overloaded(model, lambda, count, status)
      type(element_model), intent(inout) :: model    !! all its displacements are those of a solution
      real(wp), intent(in) :: lambda
      integer, intent(out) :: count                  !! points damaged
      integer(c_int), intent(out) :: status          !! not_positive_definite: a mechanism
      real(wp), parameter :: tolerance = 1.0e-9_wp
      type(scan_result) :: found
      type(event_vectors) :: event
      type(bound) :: worst
      real(wp) :: ratio
      integer(c_int) :: node, direction
      integer :: g, e, i, tooth

      count = 0
      status = status_ok
      do g = 1, size(model%mesh%holders)
         select type (group => model%mesh%holders(g)%group)
         class is (point_group)
            do e = 1, group%elements
               found = scan_result()
               call group%scan(e, e, model%solution%ua, model%solution%ub, lambda, model%search%noise, found)
               worst = bound()
               if (found%empty%point /= 0) then
                  worst = found%empty
               else if (found%hi%point /= 0 .and. found%hi%value < lambda - tolerance * abs(lambda)) then
                  worst = found%hi
               else if (found%lo%point /= 0 .and. found%lo%value > lambda + tolerance * abs(lambda)) then
                  worst = found%lo
               end if
               if (worst%point == 0) cycle
               call group%damage(worst%point, worst%code, lambda, model%solution%ua, model%solution%ub, event, tooth)
               count = count + 1
               model%ledger%cracked = model%ledger%cracked + event%crack
               do i = 1, merge(event%rank, 0, event%cracks)
                  if (event%sign(i) > 0.0_wp) model%ledger%cracked = model%ledger%cracked + &
                     0.5_wp * along(event, i, model%solution%ua, model%solution%ub, lambda)**2
               end do
            end do
         end select
      end do
      if (count == 0) return
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
   end subroutine damage_overloaded

end module sla_incremental
