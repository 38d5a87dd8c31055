!> Joints of a model of sla_handle, in the plane or between shells.
module sla_joint_handle
   use common_kinds, only : wp
   use common_status, only : status_bad_index, status_invalid_argument, status_ok, status_out_of_memory
   use sla_group, only : element_group
   use sla_handle, only : group_added, group_begun
   use sla_interface, only : interface_between_shells, interface_group, interface_group_new, joint_law, joint_law_new
   use sla_model, only : element_model
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: joints_added

contains

   !> Add joints of no thickness to a model
   subroutine joints_added(handle, connect, property, choice, ripple, row, bad, status)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: connect(:, :)   !! (4, elements), 1-based: the lower side, back along the upper
      real(wp), intent(in) :: property(:, :)        !! (8, elements), see api_sla_joints
      integer(c_int), intent(in) :: choice(:, :)    !! (4, elements), see api_sla_joints
      real(wp), intent(in) :: ripple                !! half-width of the steps of friction over the friction
      real(wp), intent(in) :: row(:, :, :)          !! (24, 3, points) of joints between shells; of none in the plane
      integer(c_int), intent(out) :: bad            !! element without area or normal, 1-based
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(interface_group), allocatable :: new_joints
      class(element_group), allocatable :: group
      type(joint_law) :: strength
      logical :: in_space
      integer :: info
      bad = 0
      call group_begun(handle, connect, choice(1:3, :), model, status)
      if (status /= status_ok) return
      in_space = size(row, 3) > 0
      allocate (new_joints, stat=info)
      if (any(choice(4, :) < 0)) then
         status = status_bad_index
      else if (.not. (all(property(3:4, :) > 0.0_wp) .and. all(property(6, :) > 0.0_wp) .and. ripple > 0.0_wp .and. &
                      ripple < 0.25_wp) .or. size(model%mesh%xy, 1) /= merge(3, 2, in_space)) then
         status = status_invalid_argument
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call joint_law_new(size(connect, 2), strength, status)
      end if
      if (status == status_ok) then
         strength%kn(:) = property(3, :)
         strength%ks(:) = property(4, :)
         strength%friction(:) = property(5, :)
         strength%small(:) = property(6, :)
         strength%table(:) = choice(1, :)
         strength%crush_table(:) = choice(2, :)
         strength%slip_table(:) = choice(3, :)
         strength%dry(:) = choice(4, :)
         strength%ripple = ripple
         call interface_group_new(property(1:2, :), property(7:8, :), strength, model%mesh%teeth, model%mesh%options, &
            new_joints, bad, status)
      end if
      if (status == status_ok .and. in_space) call interface_between_shells(new_joints, row, status)
      call move_alloc(new_joints, group)
      call group_added(handle, model, connect, merge(6, 2, in_space), group, status)
   end subroutine joints_added

end module sla_joint_handle
